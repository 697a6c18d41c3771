#include "models/turntable/surface.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include "io/output_file.h"
#include "models/tables.h"
#include "models/turntable/turntable_scanner.h"

namespace scancal {
namespace {

constexpr int64_t kMostNodes = 61, kNodesNear = 41;  // per side
constexpr double kFarFromGrid = 3;                   // steps
constexpr double kLeastWidth = 0.01;                 // of a step: exact data have no U

NumberTable Table(const std::vector<PlaneStorey>& storeys, const std::vector<double>& M, const std::vector<double>& N) {
  NumberTable table = TableOf({{"M", Unit::kMm}, {"N", Unit::kMm}, {"S", Unit::kMm}});
  for (const double m : M)
    for (const double n : N) table.rows.push_back({m, n, SAt(storeys, m, n, PlaneFit::kOrthogonal)});
  return table;
}

std::vector<double> Thinned(const GridBox& box, size_t side) {
  const int64_t all = box.Nodes()[side], some = std::min(all, kMostNodes);
  std::vector<double> nodes;
  for (int64_t k = 0; k < some; ++k) {
    const int64_t i = some > 1 ? k * (all - 1) / (some - 1) : 0;
    nodes.push_back(box.At(i, i)[side]);
  }
  return nodes;
}

// Half of the square's side; nan where something is not known.
double HalfWidth(const GridBox& box, const Calibration& calibration) {
  double width = kLeastWidth * box.step, to_grid = 0;
  for (const size_t k : {0, 1}) {
    const Parameter& parameter = *calibration.Find(calibration.grid.names[k]);
    if (parameter.role != Role::kEstimate) continue;
    if (!std::isfinite(3 * parameter.U)) return 3 * parameter.U;
    width = std::max(width, 3 * parameter.U);
    to_grid = std::max(to_grid, std::abs(calibration.grid.at[k] - parameter.value));
  }
  constexpr double kMargin = 1.05;  // the minimum is not to lie on the frame
  return to_grid <= kFarFromGrid * box.step ? std::max(width, kMargin * to_grid) : width;
}

std::vector<double> Around(const Parameter& parameter, double half_width) {
  if (parameter.role != Role::kEstimate) return {parameter.value};
  std::vector<double> nodes;
  constexpr int64_t kMiddle = kNodesNear / 2;
  for (int64_t k = -kMiddle; k <= kMiddle; ++k)
    nodes.push_back(parameter.value + half_width * static_cast<double>(k) / static_cast<double>(kMiddle));
  return nodes;
}

}  // namespace

double SAt(const std::vector<PlaneStorey>& storeys, double M, double N, PlaneFit fit) {
  double sum = 0;
  for (const PlaneStorey& storey : storeys) sum += storey.Rmse(M, N, fit);
  return sum / static_cast<double>(storeys.size());
}

void AddSurface(const GridBox& box, const std::vector<PlaneStorey>& storeys, Calibration* calibration) {
  calibration->surface["search"] = Table(storeys, Thinned(box, 0), Thinned(box, 1));
  const double half_width = HalfWidth(box, *calibration);
  if (std::isfinite(half_width))
    calibration->surface["near"] =
        Table(storeys, Around(*calibration->Find("M"), half_width), Around(*calibration->Find("N"), half_width));
}

Result<void> TurntableScanner::WriteSurface(const std::filesystem::path& file) const {
  SCANCAL_ASSIGN_OR_RETURN(const TurntableStart start, Initialize());
  SCANCAL_ASSIGN_OR_RETURN(OutputFile output, OutputFile::Create(file));
  SCANCAL_RETURN_IF_ERROR(output.Write("M_mm,N_mm,S_published_mm,S_orthogonal_mm\n"));
  const GridBox box = Box();
  const auto [rows, columns] = box.Nodes();
  for (int64_t i = 0; i < rows; ++i) {
    for (int64_t j = 0; j < columns; ++j) {
      const auto [M, N] = box.At(i, j);
      SCANCAL_RETURN_IF_ERROR(output.Write(fmt::format("{:.10g},{:.10g},{:.10g},{:.10g}\n", M, N,
                                                       SAt(start.storeys, M, N, PlaneFit::kVertical),
                                                       SAt(start.storeys, M, N, PlaneFit::kOrthogonal))));
    }
  }
  return output.Commit();
}

}  // namespace scancal
