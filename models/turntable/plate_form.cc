// How a simulated plate deviates from its plane.
#include <algorithm>
#include <cmath>
#include <numbers>
#include "models/turntable/simulate.h"

namespace scancal::turntable {
namespace {

constexpr int kWaves = 8;
constexpr int kNodes = 40;  // a side, where waves are made free of a plane and scaled

double Node(int k) { return (2 * k + 1.0) / kNodes - 1; }

}  // namespace

PlateForm::PlateForm(FormKind kind, double rms, const PlateRectangle& over, Random random) : over_(over) {
  if (kind == FormKind::kModes) {
    DrawModes(rms, &random);
  } else {
    DrawWaves(kind, rms, &random);
  }
}

void PlateForm::DrawModes(double rms, Random* random) {
  for (int k = 0; k < kFormModes; ++k) modes_.push_back(rms * random->Normal());
}

void PlateForm::DrawWaves(FormKind kind, double rms, Random* random) {
  const bool bent = kind == FormKind::kBent;
  const double longer = std::max(over_.half_u, over_.half_v);
  for (int k = 0; k < kWaves; ++k) {  // lengths in half sides
    const double length = bent ? 2 + 4 * random->Uniform() : 1.5 + 2.5 * random->Uniform();
    const double direction = std::numbers::pi * random->Uniform(), phase = 2 * std::numbers::pi * random->Uniform();
    const double along_u = 2 * std::numbers::pi / length * std::cos(direction),
                 along_v = 2 * std::numbers::pi / length * std::sin(direction);
    waves_.push_back(
        {along_u * (bent ? over_.half_u / longer : 1), along_v * (bent ? over_.half_v / longer : 1), phase});
  }
  amplitude_ = 1;
  double sums[3] = {0, 0, 0}, nodes_squared = 0, squares = 0;
  for (int i = 0; i < kNodes; ++i) {
    nodes_squared += Node(i) * Node(i) / kNodes;
    for (int j = 0; j < kNodes; ++j) {
      const double height = Waves(Node(i), Node(j)) / (kNodes * kNodes);
      sums[0] += height;
      sums[1] += height * Node(i);
      sums[2] += height * Node(j);
    }
  }
  for (int k = 0; k < 3; ++k) plane_[k] = k == 0 ? sums[k] : sums[k] / nodes_squared;
  for (int i = 0; i < kNodes; ++i)
    for (int j = 0; j < kNodes; ++j) squares += std::pow(Waves(Node(i), Node(j)), 2) / (kNodes * kNodes);
  amplitude_ = rms / std::sqrt(squares);
}

double PlateForm::Waves(double u, double v) const {
  double sum = -plane_[0] - plane_[1] * u - plane_[2] * v;
  for (const Wave& wave : waves_) sum += std::cos(wave.along_u * u + wave.along_v * v + wave.phase);
  return amplitude_ * sum;
}

double PlateForm::At(double u, double v) const {
  if (modes_.empty() && waves_.empty()) return 0;
  u = (u - over_.centre_u) / over_.half_u;
  v = (v - over_.centre_v) / over_.half_v;
  if (!waves_.empty()) return Waves(u, v);
  double sum = 0;
  const FormModes modes = FormModesAt(u, v, over_.half_u / over_.half_v);
  for (size_t k = 0; k < modes_.size(); ++k) sum += modes_[k] * modes[k];
  return sum;
}

}  // namespace scancal::turntable
