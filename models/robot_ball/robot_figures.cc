#include "models/robot_ball/robot_figures.h"
#include <cmath>
#include "models/parts/figure_tables.h"
#include "models/robot_ball/hand_eye.h"

namespace scancal {
namespace {

Eigen::Vector3d MeanOf(const std::vector<RobotBall::SeenBall>& balls) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const RobotBall::SeenBall& ball : balls) sum += ball.centre;
  return sum / static_cast<double>(balls.size());
}

void AddResiduals(const RobotData& data, const RobotFit& fit, size_t t, TargetSummary* target) {
  const Station& station = fit.stations[t];
  const std::vector<Eigen::VectorXd> residuals = ResidualsOf(fit.solution, t);
  const RobotSetup setup = fit.Setup(), flange{Eigen::Isometry3d::Identity(), setup.link_errors};
  NumberTable poses = PoseTable(data.links.size(), {{"balls", Unit::kOne}, {"rms", Unit::kMm}}),
              balls = PointResidualTable();
  for (size_t v = 0; v < station.views.size(); ++v) {
    const RobotBall::View& view = station.views[v];
    const Eigen::VectorXd& r = residuals[v];
    poses.names.push_back(view.name);
    AddPose(view.joints, BaseFromScanner(data, flange, view).translation(),
            {static_cast<double>(view.balls.size()), std::sqrt(r.squaredNorm() / static_cast<double>(r.size()))},
            &poses);
    for (size_t b = 0; b < view.balls.size(); ++b) {
      const Eigen::Vector3d of_ball = r.segment<3>(3 * static_cast<Eigen::Index>(b));
      balls.names.push_back(data.spheres[view.balls[b].sphere].name);
      balls.rows.push_back({static_cast<double>(v), of_ball[0], of_ball[1], of_ball[2]});
    }
  }
  target->residual_tables = {{"poses", poses}, {"balls", balls}};
}

void AddScene(const RobotData& data, const RobotFit& fit, size_t t, TargetSummary* target) {
  NumberTable outline = PointTable(), views = SightTable();
  for (const RobotBall::Sphere& sphere : data.spheres) {
    outline.names.push_back(sphere.name);
    AddPoint(fit.BaseFromArtifact(t) * sphere.centre, &outline);
  }
  for (const RobotBall::View& view : fit.stations[t].views) {
    const Eigen::Isometry3d base_from_scanner = BaseFromScanner(data, fit.Setup(), view);
    views.names.push_back(view.name);
    AddSight(base_from_scanner.translation(), base_from_scanner * MeanOf(view.balls), &views);
  }
  target->scene = {{"outline", outline}, {"views", views}};
}

}  // namespace

void AddRobotFigures(const RobotData& data, const RobotFit& fit, Calibration* calibration) {
  for (size_t t = 0; t < calibration->targets.size(); ++t) {
    AddResiduals(data, fit, t, &calibration->targets[t]);
    AddScene(data, fit, t, &calibration->targets[t]);
  }
  AddNominal(data.links, calibration);
}

}  // namespace scancal
