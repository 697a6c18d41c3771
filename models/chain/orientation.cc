#include "models/chain/orientation.h"
#include <fmt/format.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include "io/message.h"

namespace scancal {
namespace {

constexpr double kTolerance = 1e-3;  // of a length that is 1, written with four digits

constexpr char kChoices[] =
    "quaternion (columns qx, qy, qz, qw), quaternion wxyz (ABB) or quaternion xyzw (columns q1 .. q4), KUKA ABC, FANUC "
    "WPR, rotation vector (UR), XYZ intrinsic (each turn about axes that turned along) or XYZ extrinsic (about fixed "
    "axes) and any other order of axes, rotation matrix (columns r11 .. r33)";

// In upper case, one blank between words.
std::string Plain(const std::string& name) {
  std::string plain;
  for (const char c : name) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (letter) plain += static_cast<char>(c & ~0x20);
    else if (!plain.empty() && plain.back() != ' ') plain += ' ';
  }
  while (plain.ends_with(' ')) plain.pop_back();
  return plain;
}

// XYZ, ZYZ, ...: neighbours differ.
bool IsOrder(const std::string& axes) {
  return axes.size() == 3 && axes.find_first_not_of("XYZ") == std::string::npos && axes[0] != axes[1] &&
         axes[1] != axes[2];
}

std::string PoseOf(const Table& table, size_t row) {
  return table.Has("pose") ? " of pose " + Quoted(table.Text("pose", row)) : "";
}

}  // namespace

Orientation::Orientation() : Orientation("quaternion", Kind::kQuaternion, {"qx", "qy", "qz", "qw"}) {}

std::string OrientationRemedy() { return "orientation: " + std::string(kChoices); }

Orientation Orientation::Euler(std::string name, const std::string& axes, bool intrinsic,
                               std::vector<std::string> columns) {
  Orientation euler(std::move(name), Kind::kEuler, std::move(columns));
  for (size_t k = 0; k < 3; ++k) euler.axes_[k] = axes[k] - 'X';
  if (intrinsic) return euler;
  std::reverse(euler.axes_.begin(), euler.axes_.end());  // a turn about a fixed axis comes from the left
  std::reverse(euler.columns_.begin(), euler.columns_.end());
  return euler;
}

Result<Orientation> Orientation::Named(const std::string& name) {
  const std::string plain = Plain(name);
  const auto is = [&](std::initializer_list<const char*> names) {
    return std::any_of(names.begin(), names.end(), [&](const char* each) { return plain == each; });
  };
  if (is({"QUATERNION"})) return Orientation();
  if (is({"QUATERNION WXYZ", "WXYZ", "ABB"}))
    return Orientation("quaternion wxyz", Kind::kQuaternion, {"q2", "q3", "q4", "q1"});
  if (is({"QUATERNION XYZW", "XYZW"}))
    return Orientation("quaternion xyzw", Kind::kQuaternion, {"q1", "q2", "q3", "q4"});
  if (is({"KUKA ABC", "KUKA", "ABC"})) return Euler("KUKA ABC", "ZYX", true, {"a", "b", "c"});
  if (is({"FANUC WPR", "FANUC", "WPR"})) return Euler("FANUC WPR", "XYZ", false, {"w", "p", "r"});
  if (is({"ROTATION VECTOR", "UR ROTATION VECTOR", "UR"}))
    return Orientation("rotation vector", Kind::kVector, {"rx", "ry", "rz"});
  if (is({"ROTATION MATRIX", "MATRIX"}))
    return Orientation("rotation matrix", Kind::kMatrix,
                       {"r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"});
  const std::string axes = plain.substr(0, plain.find(' '));
  if (!IsOrder(axes)) return Error{"expected one of: " + std::string(kChoices)};
  const bool intrinsic = plain == axes + " INTRINSIC";
  if (!intrinsic && plain != axes + " EXTRINSIC")
    return Error{fmt::format(
        "expected {0} intrinsic (each about axes that the turns before moved along) or {0} extrinsic (all about fixed "
        "axes)",
        axes)};
  std::vector<std::string> columns = {"r1", "r2", "r3"};
  for (size_t k = 0; k < 3 && axes[0] != axes[2]; ++k)
    columns[k] = std::string("r") + static_cast<char>(axes[k] | 0x20);
  return Euler(axes + (intrinsic ? " intrinsic" : " extrinsic"), axes, intrinsic, columns);
}

std::vector<TableColumn> Orientation::Columns(bool required, const std::string& remedy) const {
  const bool angles = kind_ == Kind::kEuler || kind_ == Kind::kVector;
  std::vector<TableColumn> columns;
  for (const std::string& name : columns_)
    columns.push_back({name, Cells::kNumber, angles ? Dimension::kAngle : Dimension::kNone, required, remedy});
  return columns;
}

bool Orientation::IsIn(const Table& table) const {
  return std::all_of(columns_.begin(), columns_.end(), [&](const std::string& name) { return table.Has(name); });
}

Eigen::Matrix3d Orientation::MatrixOf(const Numbers& n) const {
  switch (kind_) {
    case Kind::kQuaternion:
      return Eigen::Quaterniond(n[3], n[0], n[1], n[2]).normalized().toRotationMatrix();
    case Kind::kVector: {
      const Eigen::Vector3d vector(n[0], n[1], n[2]);
      return Eigen::AngleAxisd(vector.norm(), vector.stableNormalized()).toRotationMatrix();
    }
    case Kind::kMatrix:  // rounded: the nearest one
      return Eigen::Quaterniond(Eigen::Matrix3d(Eigen::Matrix<double, 3, 3, Eigen::RowMajor>::Map(n.data())))
          .normalized()
          .toRotationMatrix();
    case Kind::kEuler:
      break;
  }
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  for (size_t k = 0; k < 3; ++k)
    turn = turn * Eigen::AngleAxisd(n[k], Eigen::Vector3d::Unit(axes_[k])).toRotationMatrix();
  return turn;
}

std::string Orientation::Doubt(const Numbers& n) const {
  if (kind_ == Kind::kQuaternion) {
    const double length = Eigen::Vector4d(n[0], n[1], n[2], n[3]).norm();
    return std::abs(length - 1) <= kTolerance ? "" : fmt::format("has length {:.6g}, expected 1", length);
  }
  if (kind_ == Kind::kMatrix) {
    const Eigen::Matrix3d matrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>::Map(n.data());
    if (!((matrix.transpose() * matrix - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= kTolerance))
      return "has rows that are not of length 1 and at right angles";
    return matrix.determinant() > 0 ? "" : "mirrors, expected one that turns";
  }
  for (size_t k = 0; k < 3; ++k)
    if (std::abs(n[k]) > 2 * kTurn_rad)
      return fmt::format("is {:.4g} rad, expected two turns at most; are these degrees? See units: angle", n[k]);
  return "";
}

Result<std::vector<Eigen::Matrix3d>> Orientation::Read(const Table& table) const {
  const bool angles = kind_ == Kind::kEuler || kind_ == Kind::kVector;
  std::string called;
  std::vector<std::string> named = columns_;
  if (named[0].back() <= '9') std::sort(named.begin(), named.end());  // as they stand in the file
  for (const std::string& name : named) called += (called.empty() ? "" : ", ") + table.Called(name);
  std::vector<Eigen::Matrix3d> turns;
  double largest = 0;
  for (size_t row = 0; row < table.rows(); ++row) {
    Numbers numbers = {};
    size_t worst = 0;
    for (size_t k = 0; k < columns_.size(); ++k) {
      numbers[k] = table.Number(columns_[k], row);
      if (angles && std::abs(numbers[k]) > std::abs(numbers[worst])) worst = k;
      largest = std::max(largest, std::abs(numbers[k]));
    }
    if (const std::string doubt = Doubt(numbers); !doubt.empty())
      return table.Wrong(
          row, columns_[worst],
          (angles ? "the angle" + PoseOf(table, row) : "the " + name_ + " " + called + PoseOf(table, row)) + " " +
              doubt);
    turns.push_back(MatrixOf(numbers));
  }
  if (angles && largest > 0 && largest <= kTurn_rad * kDegree)
    return Error{
        fmt::format("{}: all angles {} lie within {:.3g} deg, expected poses that turn; are these radians? See "
                    "units: angle",
                    table.name(), called, largest / kDegree)};
  return turns;
}

}  // namespace scancal
