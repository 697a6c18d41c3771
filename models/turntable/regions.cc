#include "models/turntable/regions.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace scancal::turntable {
namespace {

constexpr size_t kHole = 6;                        // cells that are missing within a plane
constexpr int32_t kBlock = 6;                      // cells, the side of a block that may be off
constexpr double kOffBlock = 1.5, kOffSingle = 4;  // sigma: the mean of a block, more where it has few cells
constexpr int32_t kParts = 6;                      // of a region, either way, that are asked whether it is bent
constexpr double kBent = 0.8;                      // sigma

size_t Place(int32_t cell) { return static_cast<size_t>(cell); }

struct CellBox {
  int32_t top, bottom, left, right;  // all within
};
CellBox BoxAround(const CellGrid& grid, const std::vector<int32_t>& cells) {
  CellBox box = {cells.front() / grid.columns, cells.back() / grid.columns, grid.columns, 0};
  for (const int32_t cell : cells) {
    box.left = std::min(box.left, cell % grid.columns);
    box.right = std::max(box.right, cell % grid.columns);
  }
  return box;
}

// Adds to `group`, of which the first are there, all cells that hang together with them; is_one: whether a cell
// belongs, asked once each. across: whether corners touch.
template <class IsOne>
void Gather(const CellGrid& grid, bool corners, const IsOne& is_one, std::vector<int32_t>* group) {
  for (size_t g = 0; g < group->size(); ++g) {
    const int32_t r = (*group)[g] / grid.columns, c = (*group)[g] % grid.columns;
    for (int32_t dr = -1; dr <= 1; ++dr) {
      for (int32_t dc = -1; dc <= 1; ++dc) {
        if ((!corners && dr != 0 && dc != 0) || r + dr < 0 || c + dc < 0 || r + dr >= grid.rows ||
            c + dc >= grid.columns)
          continue;
        const int32_t cell = (r + dr) * grid.columns + c + dc;
        if (is_one(cell)) group->push_back(cell);
      }
    }
  }
}

void FillHoles(const CellGrid& grid, std::vector<char>* in) {
  std::vector<char> seen = *in;
  std::vector<int32_t> group;
  const auto is_one = [&](int32_t cell) { return std::exchange(seen[Place(cell)], 1) == 0; };
  for (int32_t k = 0; k < std::ssize(seen); ++k) {
    if (!is_one(k)) continue;
    group.assign(1, k);
    Gather(grid, /*corners=*/false, is_one, &group);
    if (group.size() > kHole) continue;
    for (const int32_t cell : group) (*in)[Place(cell)] = 1;
  }
}

// Of `lines` lines of cells: takes out what is within `by` of a cell that is out.
void ErodeLines(std::vector<char>* in, int32_t lines, int32_t length, size_t line_step, size_t step, int32_t by) {
  std::vector<int32_t> next_out(Place(length));
  for (int32_t line = 0; line < lines; ++line) {
    char* const at = in->data() + Place(line) * line_step;
    int32_t next = length + by + 1, last = -by - 1;
    for (int32_t k = length; k-- > 0;) next_out[Place(k)] = next = at[Place(k) * step] ? next : k;
    for (int32_t k = 0; k < length; ++k) {
      char& cell = at[Place(k) * step];
      if (!cell) last = k;
      cell = static_cast<char>(k - last > by && next_out[Place(k)] - k > by);
    }
  }
}

}  // namespace

std::vector<int32_t> Eroded(const CellGrid& grid, const std::vector<int32_t>& cells, int32_t rows, int32_t columns) {
  const int32_t top = std::max(0, cells.front() / grid.columns - rows);
  const int32_t bottom = std::min(grid.rows, cells.back() / grid.columns + rows + 1);
  const CellGrid part = {bottom - top, grid.columns};
  const auto width = Place(grid.columns);
  std::vector<char> in(Place(part.rows) * width, 0);
  const int32_t shift = top * grid.columns;
  for (const int32_t cell : cells) in[Place(cell - shift)] = 1;
  FillHoles(part, &in);
  ErodeLines(&in, part.rows, part.columns, width, 1, columns);
  ErodeLines(&in, part.columns, part.rows, 1, width, rows);
  std::vector<int32_t> left;
  for (const int32_t cell : cells)
    if (in[Place(cell - shift)]) left.push_back(cell);
  return left;
}

std::vector<int32_t> WithoutFragments(const CellGrid& grid, const std::vector<int32_t>& cells, size_t fewest) {
  if (cells.size() < fewest) return {};
  const int32_t shift = cells.front() / grid.columns * grid.columns;
  const CellGrid part = {(cells.back() - shift) / grid.columns + 1, grid.columns};
  std::vector<char> in(Place(part.rows) * Place(part.columns), 0);
  for (const int32_t cell : cells) in[Place(cell - shift)] = 1;
  const auto is_one = [&](int32_t cell) { return std::exchange(in[Place(cell)], 0) != 0; };
  std::vector<int32_t> left, group;
  for (const int32_t cell : cells) {
    if (!is_one(cell - shift)) continue;
    group.assign(1, cell - shift);
    Gather(part, /*corners=*/true, is_one, &group);
    if (group.size() < fewest) continue;
    for (const int32_t each : group) left.push_back(each + shift);
  }
  std::sort(left.begin(), left.end());
  return left;
}

bool AreNear(const CellGrid& grid, const std::vector<int32_t>& a, const std::vector<int32_t>& b, int32_t gap) {
  const CellBox of_a = BoxAround(grid, a), of_b = BoxAround(grid, b);
  return of_a.top - of_b.bottom <= gap && of_b.top - of_a.bottom <= gap && of_a.left - of_b.right <= gap &&
         of_b.left - of_a.right <= gap;
}

void DropOffBlocks(const CellGrid& grid, const std::vector<double>& off, double sigma, std::vector<int32_t>* cells) {
  const int32_t across = grid.columns / kBlock + 1;
  std::vector<std::pair<double, double>> sums(Place(grid.rows / kBlock + 1) * Place(across));
  const auto of = [&](int32_t cell) -> std::pair<double, double>& {
    return sums[Place(cell / grid.columns / kBlock * across + cell % grid.columns / kBlock)];
  };
  for (size_t k = 0; k < cells->size(); ++k) {
    of((*cells)[k]).first += off[k];
    of((*cells)[k]).second += 1;
  }
  std::erase_if(*cells, [&](int32_t cell) {
    const auto& [sum, count] = of(cell);
    return std::abs(sum) > (kOffBlock + kOffSingle / std::sqrt(count)) * sigma * count;
  });
}

bool IsBent(const CellGrid& grid, const std::vector<int32_t>& cells, const std::vector<double>& off, double sigma) {
  const CellBox box = BoxAround(grid, cells);
  struct Part {
    double sum = 0, count = 0, rows = 0;
    int32_t last = -1;
  };
  std::array<Part, static_cast<size_t>(kParts * kParts)> parts;
  for (size_t k = 0; k < cells.size(); ++k) {
    const int32_t row = cells[k] / grid.columns, column = cells[k] % grid.columns;
    const int32_t r = (row - box.top) * kParts / (box.bottom - box.top + 1);
    const int32_t c = (column - box.left) * kParts / (box.right - box.left + 1);
    Part& part = parts[Place(r * kParts + c)];
    part.sum += off[k];
    part.count += 1;
    part.rows += static_cast<double>(part.last != row);
    part.last = row;
  }
  double squares = 0, expected = 0, all = 0;
  for (const Part& part : parts) {
    if (part.count < static_cast<double>(cells.size()) / (4 * kParts * kParts)) continue;
    squares += part.sum * part.sum / part.count;
    expected += part.count * sigma * sigma / part.rows;
    all += part.count;
  }
  return std::sqrt(squares / all) > kBent * sigma + 2 * std::sqrt(expected / all);
}

}  // namespace scancal::turntable
