#include "models/flange_ball/flange_ball_figures.h"
#include <cmath>
#include "models/parts/figure_tables.h"

namespace scancal {

void AddFlangeBallFigures(const std::vector<Link>& nominal, const std::vector<FlangeBall::Target>& tools,
                          const Solution& solution, Calibration* calibration) {
  const RobotWithBall robot = RobotOf(nominal, solution);
  for (size_t t = 0; t < tools.size(); ++t) {
    const std::vector<Eigen::VectorXd> residuals = ResidualsOf(solution, t);
    NumberTable poses = PoseTable(nominal.size(), {{"socket", Unit::kOne}, {"rms", Unit::kMm}}),
                balls = PointResidualTable(), outline = PointTable(), views = SightTable();
    for (size_t v = 0; v < tools[t].views.size(); ++v) {
      const FlangeBall::View& view = tools[t].views[v];
      const Eigen::Vector3d r = residuals[v], flange = BaseFromFlange(robot.links, view.joints).translation();
      AddPose(view.joints, flange, {static_cast<double>(view.socket), r.norm() / std::sqrt(3.0)}, &poses);
      balls.rows.push_back({static_cast<double>(v), r[0], r[1], r[2]});
      AddSight(flange, robot.InBase(view.joints), &views);
    }
    for (const int socket : {0, 1}) AddPoint(robot.Socket(tools[t], socket), &outline);
    calibration->targets[t].residual_tables = {{"poses", poses}, {"balls", balls}};
    calibration->targets[t].scene = {{"outline", outline}, {"views", views}};
  }
  AddNominal(nominal, calibration);
}

}  // namespace scancal
