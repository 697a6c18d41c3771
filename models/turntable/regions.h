// Regions of an image: lists of cells, row * columns + column, ascending and not empty.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace scancal::turntable {

struct CellGrid {
  int32_t rows = 0, columns = 0;
};

// Without what lies within so many rows and columns of a cell that is no part of the region, and no mere hole in it: a
// few cells that touch each other by their sides. What lies outside the image counts as part.
std::vector<int32_t> Eroded(const CellGrid& grid, const std::vector<int32_t>& cells, int32_t rows, int32_t columns);

// Of pieces that do not hang together those with that many cells.
std::vector<int32_t> WithoutFragments(const CellGrid& grid, const std::vector<int32_t>& cells, size_t fewest);

// Whether the rectangles around two regions are at most `gap` cells apart.
bool AreNear(const CellGrid& grid, const std::vector<int32_t>& a, const std::vector<int32_t>& b, int32_t gap);

// off: of each cell, from the plane of the region, whose noise is sigma.
//
// Leaves out small blocks that are off the plane on average: where another surface meets it at a small angle, that is
// within any tolerance of single points for some way.
void DropOffBlocks(const CellGrid& grid, const std::vector<double>& off, double sigma, std::vector<int32_t>* cells);
// Whether large parts of the region are off by more than half of sigma, and by more than noise explains that all points
// of a row may share.
bool IsBent(const CellGrid& grid, const std::vector<int32_t>& cells, const std::vector<double>& off, double sigma);

}  // namespace scancal::turntable
