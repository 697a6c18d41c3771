// The published methods and the refinement on the same robot (Zhou et al. 2025, Table 4 and Figure 8).
#include <chrono>
#include <cmath>
#include <functional>
#include "io/progress.h"
#include "models/robot_ball/hand_eye.h"
#include "models/robot_ball/mu_2017.h"
#include "models/robot_ball/ren_2012.h"
#include "models/robot_ball/robot_fit.h"
#include "models/robot_ball/robot_scanner.h"
#include "models/robot_ball/spacing.h"
#include "models/robot_ball/virtual_point.h"
#include "models/robot_ball/zhou_2025.h"

namespace scancal {
namespace {

constexpr size_t kMostPositions = 12;  // that fit into a line

struct Method {
  const char* name;
  std::function<Result<RobotSetup>()> find;
};

// Distance of the balls from where the artifact of their station puts them, once every station stands at its best.
Result<double> Misclosure(const RobotData& data, const RobotSetup& setup) {
  SCANCAL_ASSIGN_OR_RETURN(const std::vector<Station> stations, StationsAt(data, setup));
  double squares = 0, count = 0;
  for (const Station& station : stations) {
    for (const RobotBall::View& pose : station.views) {
      const Eigen::Isometry3d base_from_scanner = BaseFromScanner(data, setup, pose);
      for (const RobotBall::SeenBall& ball : pose.balls) {
        squares += (base_from_scanner * ball.centre - station.base_from_artifact * data.spheres[ball.sphere].centre)
                       .squaredNorm();
        ++count;
      }
    }
  }
  return std::sqrt(squares / count);
}

ComparisonRow RowOf(const RobotData& data, const Method& method) {
  ComparisonRow row{method.name, {}, ""};
  Progress progress(method.name);
  const auto began = std::chrono::steady_clock::now();
  const Result<RobotSetup> setup = method.find();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - began;
  const Result<double> misclosure = setup.ok() ? Misclosure(data, *setup) : Result<double>(setup.error());
  if (!misclosure.ok()) {
    row.note = "left out: " + misclosure.error().message;
    return row;
  }
  if (!data.check.empty()) {
    const std::vector<double> errors = SpacingErrors(data, *setup);
    const ErrorSize size = SizeOfErrors(errors);
    row.cells = {{size.max}, {size.mean}};
    for (size_t k = 0; k < errors.size() && k < kMostPositions; ++k) row.cells.push_back({errors[k]});
  }
  row.cells.push_back({*misclosure});
  row.cells.push_back({seconds.count()});
  return row;
}

}  // namespace

Result<Comparison> RobotScanner::Compare(const CompareChoice&) const {
  const RobotData& data = declaration_.data;
  Comparison comparison;
  if (!data.check.empty()) comparison.columns = {{"max/mm"}, {"mean/mm"}};
  for (size_t k = 0; k < data.check.size() && k < kMostPositions; ++k)
    comparison.columns.push_back({std::to_string(k + 1), 2});
  comparison.columns.push_back({"rms of balls/mm"});
  comparison.columns.push_back({"s", 2, true});
  const std::vector<Method> methods = {{"nominal robot, first hand-eye", [&] { return VirtualPointHandEye(data); }},
                                       {"Ren 2012, single sphere", [&] { return Ren2012(data); }},
                                       {"Mu 2017, distances", [&] { return Mu2017(data); }},
                                       {"Zhou 2025, corrected distances", [&] { return Zhou2025(data); }},
                                       {"joint refinement", [&]() -> Result<RobotSetup> {
                                          SCANCAL_ASSIGN_OR_RETURN(const RobotSetup start, InitialHandEye(data));
                                          SCANCAL_ASSIGN_OR_RETURN(const RobotFit fit,
                                                                   FitRobot(data, model_, start.flange_from_scanner));
                                          return fit.Setup();
                                        }}};
  for (const Method& method : methods) comparison.rows.push_back(RowOf(data, method));
  return comparison;
}

}  // namespace scancal
