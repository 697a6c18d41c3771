// A room with clutter as a turning profiler scans it, up and down, without a crop: an independent way to write the
// model down.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>
#include "io/units.h"

namespace scancal {

struct RoomPoint {
  double angle = 0, y = 0, z = 0;  // deg, mm; y is nan where nothing returned
  int surface = 0;                 // which plane it is on; 0: mixed pixel, spike or nothing; below: curved things
};

// Walls around the axis, a slab that leans, two boxes, a column and a ball; all drawn from the seed.
class Room {
 public:
  using Vector = std::array<double, 3>;
  double M = 123, N = 409, noise = 0.05, jitter = 1e-5;  // mm; rad, one a profile
  double sweep = 100, half_line = 120;                   // deg, mm
  int profiles = 160, points = 120;                      // of each of two sweeps
  double missing = 0.02, spikes = 0.005;
  bool planes = true;  // false: nothing but curved things

  explicit Room(unsigned seed) : random_(seed) {
    for (int k = 0; k < 3; ++k)
      walls_.push_back({Within(-55 + 50 * k, -25 + 50 * k), Within(-18, 18), Within(620, 760)});
    for (int k = 0; k < 3; ++k) {
      Box& box = boxes_.emplace_back();
      const double at = Within(-38 + 28 * k, -24 + 28 * k) * kDegree, away = Within(520, 570);
      box.centre = {-away * std::sin(at), -away * std::cos(at), Within(-50, 20)};
      box.half = {Within(35, 60), k == 1 ? 5 : Within(20, 35), Within(40, 70)};
      box.turn = at + Within(-30, 30) * kDegree;
      box.lean = k == 1 ? Within(8, 20) * kDegree : 0;
    }
    column_ = {-540 * std::sin(0.62), -540 * std::cos(0.62), 28};
    ball_ = {-590 * std::sin(-0.75), -590 * std::cos(-0.75), 40};
  }

  std::vector<RoomPoint> Scan() {
    std::vector<RoomPoint> scan;
    for (int k = 0; k < 2 * profiles; ++k) {
      const int at = k < profiles ? k : 2 * profiles - 1 - k;
      const double step = sweep / profiles, angle = (at + (k < profiles ? 0.5 : 0.25)) * step - sweep / 2;
      const double turned = angle * kDegree + jitter * Normal();
      for (int i = 0; i < points; ++i) {
        const double pitch = 2 * half_line / (points - 1), z = -half_line + i * pitch;
        RoomPoint p{angle, 0, z, 0};
        const auto [depth, surface] = Sight(turned, z);
        const auto [beside, other] = Sight(turned + Within(-0.5, 0.5) * step * kDegree, z + Within(-0.5, 0.5) * pitch);
        p.y = depth + noise * Normal();
        p.surface = surface;
        if (std::abs(beside - depth) > 5) {  // the spot sees both
          p.y += (beside - depth) * Within(0, 1);
          p.surface = 0;
        }
        if (Within(0, 1) < spikes) {
          p.y += Within(-30, 30);
          p.surface = 0;
        }
        if (Within(0, 1) < missing || surface == 0) p.y = std::nan("");
        scan.push_back(p);
      }
    }
    return scan;
  }

 private:
  struct Wall {
    double turn, lean, distance;  // deg, mm
  };
  struct Box {
    Vector centre, half;
    double turn, lean;  // about the vertical, then about its own x
  };
  double Within(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double Normal() { return std::normal_distribution<double>()(random_); }

  // Depth, eq. (7): x = M cos a - (N + y) sin a, y = -M sin a - (N + y) cos a; and what is there.
  std::pair<double, int> Sight(double a, double z) const {
    const Vector from = {M * std::cos(a) - N * std::sin(a), -M * std::sin(a) - N * std::cos(a), z};
    const Vector along = {-std::sin(a), -std::cos(a), 0};
    std::pair<double, int> nearest = {2000, 0};
    const auto see = [&](double depth, int surface) {
      if (depth > 20 && depth < nearest.first) nearest = {depth, surface};
    };
    for (size_t k = 0; k < walls_.size() && planes; ++k) {
      const double turn = walls_[k].turn * kDegree, lean = walls_[k].lean * kDegree;
      const Vector n = {-std::sin(turn) * std::cos(lean), -std::cos(turn) * std::cos(lean), std::sin(lean)};
      const double slope = n[0] * along[0] + n[1] * along[1];
      if (slope > 0.05) see((walls_[k].distance - Dot(n, from)) / slope, static_cast<int>(k) + 1);
    }
    for (size_t k = 0; k < boxes_.size() && planes; ++k)
      SeeBox(boxes_[k], from, along, 10 * (static_cast<int>(k) + 1), see);
    const double x = from[0] - column_[0], y = from[1] - column_[1], half = x * along[0] + y * along[1];
    if (const double under = half * half - x * x - y * y + column_[2] * column_[2]; under > 0)
      see(-half - std::sqrt(under), -1);
    const double u = from[0] - ball_[0], v = from[1] - ball_[1], h = u * along[0] + v * along[1];
    if (const double under = h * h - u * u - v * v - z * z + ball_[2] * ball_[2]; under > 0)
      see(-h - std::sqrt(under), -2);
    return nearest;
  }

  static double Dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

  template <class See>
  static void SeeBox(const Box& box, const Vector& from, const Vector& along, int first_surface, const See& see) {
    const double c = std::cos(box.turn), s = std::sin(box.turn), cl = std::cos(box.lean), sl = std::sin(box.lean);
    const std::array<Vector, 3> axes = {Vector{c, -s, 0}, Vector{s * cl, c * cl, sl}, Vector{-s * sl, -c * sl, cl}};
    const Vector d = {from[0] - box.centre[0], from[1] - box.centre[1], from[2] - box.centre[2]};
    double enter = -1e9, leave = 1e9;
    int face = 0;
    for (int k = 0; k < 3; ++k) {
      const double at = Dot(axes[static_cast<size_t>(k)], d), by = Dot(axes[static_cast<size_t>(k)], along);
      const double half = box.half[static_cast<size_t>(k)];
      if (std::abs(by) < 1e-12) {
        if (std::abs(at) > half) return;
        continue;
      }
      const double near = (-at - std::copysign(half, by)) / by, far = (-at + std::copysign(half, by)) / by;
      if (near > enter) {
        enter = near;
        face = 2 * k + (by > 0 ? 1 : 0);
      }
      leave = std::min(leave, far);
    }
    if (enter < leave) see(enter, first_surface + face);
  }

  std::mt19937 random_;
  std::vector<Wall> walls_;
  std::vector<Box> boxes_;
  Vector column_, ball_;  // x, y, radius
};

}  // namespace scancal
