// Points of a few numbers each: read as typed or from a table, written as a cloud.
#pragma once
#include <array>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>
#include "io/result.h"
#include "io/scan.h"

namespace scancal {

struct PointRequest {
  std::string typed;                        // "10,50,-20; 12,50,-20": in the order of the columns
  std::filesystem::path file;               // one point a line, as a scan file has them; empty: none
  Units units;                              // of the typed ones, and of columns without a unit in their name
  double angle_sense = 1, depth_sense = 1;  // of a scanner's readings, as its data set declares them
  YamlMap declared = {};                    // that data set, where it is known
};

// The typed ones first; one number per column, mm and rad. An Error without any, or where a number is missing.
Result<std::vector<std::vector<double>>> ReadPoints(const PointRequest& request,
                                                    const std::vector<ScanColumn>& columns);

Result<Units> ParseUnits(const std::string& text);  // "mm,deg": one of length, one of angle

// What stands beside the coordinates of a point: u_x, u_y, u_z in mm; xx, xy, xz, yy, yz, zz of its covariance in mm^2.
struct PointExtras {
  bool u = false, covariance = false;
  size_t size() const { return (u ? 3 : 0) + (covariance ? 6 : 0); }
};

// By extension: .ply (binary little endian; double x, y, z, extras; int scan), .csv (x_mm,y_mm,z_mm,extras,scan;
// round-trip digits), .npy (float64, shape (points, 3 + extras)). Streaming: memory does not grow with the number of
// points.
class PointCloudWriter {
 public:
  virtual ~PointCloudWriter() = default;
  const PointExtras& wants() const { return wants_; }
  // beside: wants().size() numbers a point, one point after the other.
  virtual Result<void> Write(std::span<const std::array<double, 3>> points_mm, int scan,
                             std::span<const double> beside = {}) = 0;
  virtual Result<void> Commit() = 0;

 protected:
  PointExtras wants_;
};

// An unknown extension: an error that lists them.
Result<std::unique_ptr<PointCloudWriter>> CreatePointCloud(const std::filesystem::path& path,
                                                           const PointExtras& wants = {});

}  // namespace scancal
