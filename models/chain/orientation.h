// How controllers and trackers write a turn in a table.
#pragma once
#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>
#include "io/table.h"

namespace scancal {

// By the name that `orientation:` gives it (in any case). R is the turn of the flange in the base, of the target in the
// world, Rx(a) a turn by a about x:
//
//     quaternion                columns qx, qy, qz, qw in any order; what is taken where nothing is declared
//     quaternion wxyz           q1, q2, q3, q4, the scalar part first (ABB)
//     quaternion xyzw           q1, q2, q3, q4, the scalar part last
//     KUKA ABC                  a, b, c: R = Rz(a) Ry(b) Rx(c)
//     FANUC WPR                 w, p, r: R = Rz(r) Ry(p) Rx(w)
//     rotation vector           rx, ry, rz: axis times angle (UR)
//     XYZ intrinsic             rx, ry, rz: R = Rx(rx) Ry(ry) Rz(rz), each about the axes that the ones before turned
//     XYZ extrinsic             rx, ry, rz: R = Rz(rz) Ry(ry) Rx(rx), all about fixed axes
//     ZYZ intrinsic             r1, r2, r3, where an axis comes twice: R = Rz(r1) Ry(r2) Rz(r3)
//     rotation matrix           r11, r12, .. r33: row, column
//
// Any of the 12 orders of axes. ABB, KUKA, FANUC and UR alone are the same as theirs.
class Orientation {
 public:
  Orientation();  // quaternion
  static Result<Orientation> Named(const std::string& name);

  const std::string& name() const { return name_; }
  std::vector<TableColumn> Columns(bool required, const std::string& remedy) const;
  bool IsIn(const Table& table) const;  // all columns
  // Rotation matrices, one a row. Errors name the pose and the columns as the file does: quaternions and matrices that
  // are none, angles beyond two turns or all of some degrees, which are of the other unit.
  Result<std::vector<Eigen::Matrix3d>> Read(const Table& table) const;

 private:
  enum class Kind { kQuaternion, kEuler, kVector, kMatrix };
  using Numbers = std::array<double, 9>;
  Orientation(std::string name, Kind kind, std::vector<std::string> columns)
      : name_(std::move(name)), kind_(kind), columns_(std::move(columns)) {}
  static Orientation Euler(std::string name, const std::string& axes, bool intrinsic, std::vector<std::string> columns);
  Eigen::Matrix3d MatrixOf(const Numbers& numbers) const;
  std::string Doubt(const Numbers& numbers) const;  // why it is no turn; empty: it is one

  std::string name_;
  Kind kind_ = Kind::kQuaternion;
  std::vector<std::string> columns_;  // of a quaternion: x, y, z, w; Euler angles: from the outermost turn to the inner
  std::array<int, 3> axes_ = {};      // of Euler angles: R is the product of the turns about them, in this order
};

// For the end of a sentence: "`orientation: KUKA ABC`, ...", all choices.
std::string OrientationRemedy();

}  // namespace scancal
