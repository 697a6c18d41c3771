#include "models/robot_ball/scanner.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include "io/message.h"
#include "models/chain/tables.h"
#include "models/robot_ball/fit.h"
#include "models/robot_ball/judge.h"
#include "models/robot_ball/published.h"
#include "models/robot_ball/start.h"
#include "models/robot_ball/tables.h"

namespace scancal::robot_ball {
namespace {

constexpr Message<size_t, std::string_view> kTermsHeld{
    "robot_ball.terms_held",
    "{} terms of the joints that were to be estimated are not told by these poses, and held at zero: {}",
    "{} zu schätzende Größen der Gelenke bestimmen diese Posen nicht; sie sind bei null festgehalten: {}"};
constexpr Message<std::string_view> kTurnHeld{
    "robot_ball.turn_held",
    "two reflectors do not tell how the tool turns about the line through them: {} is held where it starts; a third "
    "one "
    "beside the line would tell it",
    "Zwei Reflektoren sagen nicht, wie sich das Werkzeug um die Gerade durch sie dreht: {} ist am Startwert "
    "festgehalten; ein dritter neben der Geraden würde es bestimmen"};
constexpr Message<std::string_view, size_t> kHeldOut{"robot_ball.held_out", "held out: {}, {} poses (mean distance)",
                                                     "zurückgehalten: {}, {} Posen (mittlerer Abstand)"};

constexpr char kResidual[] = "ball centre";

Eigen::Vector3d MeanOnTool(const Measurements& data, const std::vector<Model::SeenBall>& balls) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Model::SeenBall& ball : balls) sum += data.OnTool(ball);
  return sum / static_cast<double>(balls.size());
}

void AddResiduals(const Measurements& data, const JointFit& fit, size_t t, TargetSummary* target) {
  const Station& station = fit.stations[t];
  const std::vector<Eigen::VectorXd> residuals = ResidualsOf(fit.solution, t);
  const Kinematics setup = fit.Found(), flange{Eigen::Isometry3d::Identity(), setup.link_errors};
  NumberTable poses = PoseTable(data.links.size(), {{"balls", Unit::kOne}, {"rms", Unit::kMm}}),
              balls = PointResidualTable();
  for (size_t v = 0; v < station.views.size(); ++v) {
    const Model::View& view = station.views[v];
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

void AddScene(const Measurements& data, const JointFit& fit, size_t t, TargetSummary* target) {
  NumberTable outline = PointTable(), views = SightTable();
  for (const Model::Sphere& sphere : data.spheres) {
    if (data.measured_in_world) break;  // they are on the tool
    outline.names.push_back(sphere.name);
    AddPoint(fit.BaseFromArtifact(t) * sphere.centre, &outline);
  }
  for (const Model::View& view : fit.stations[t].views) {
    const Eigen::Isometry3d base_from_scanner = BaseFromScanner(data, fit.Found(), view);
    views.names.push_back(view.name);
    AddSight(base_from_scanner.translation(), base_from_scanner * MeanOnTool(data, view.balls), &views);
  }
  target->scene = {{"outline", outline}, {"views", views}};
}

// Of every station: residual tables "poses" (named; with the number of balls and the rms of their residuals'
// coordinates) and "balls" (named; in the scanner's frame, without weights), and the scene in the base: "outline", the
// artifact's balls where the station holds them, and "views", from the scanner to the mean of the balls seen.
// Parameters get their nominal number.
void AddTables(const Measurements& data, const JointFit& fit, Calibration* calibration) {
  for (size_t t = 0; t < calibration->targets.size(); ++t) {
    AddResiduals(data, fit, t, &calibration->targets[t]);
    AddScene(data, fit, t, &calibration->targets[t]);
  }
  AddNominal(data.links, calibration);
}

void AddGeometry(const JointFit& fit, const Eigen::Vector3d& gravity, Calibration* result) {
  result->frames["hand_eye"] = fit.Found().flange_from_scanner.matrix();
  if (std::any_of(result->estimated.begin(), result->estimated.end(),
                  [](const std::string& name) { return name.starts_with("gravity"); })) {
    Eigen::Isometry3d down = Eigen::Isometry3d::Identity();  // its translation is the direction of gravity
    down.translation() = gravity;
    result->frames["gravity"] = down.matrix();
  }
  for (size_t t = 0; t < result->targets.size(); ++t) {
    const Eigen::Matrix<double, 6, 1> pose = NumbersOf(fit.BaseFromArtifact(t));
    result->targets[t].geometry = {{"base_from_artifact", {pose.data(), pose.data() + 6}}};
  }
}

// Mean distance of the points of a held-out station from where they lie, its artifact at that place; of a 6-DoF target
// that of its origin.
double MeanDistance(const Measurements& data, const Kinematics& setup, const Station& station,
                    const Eigen::Isometry3d& base_from_artifact) {
  const bool of_target = IsTarget(data.spheres);
  double sum = 0, count = 0;
  for (const Model::View& view : station.views) {
    const Eigen::Isometry3d base_from_tool = BaseFromScanner(data, setup, view);
    for (const Model::SeenBall& ball : view.balls) {
      if (of_target && ball.sphere != 0) continue;
      sum += (base_from_tool * data.OnTool(ball) - base_from_artifact * data.InWorld(ball)).norm();
      ++count;
    }
  }
  return sum / count;
}

// base_from_artifact of a held-out station: as the poses calibrated with say if it stands there, else as its own do.
std::optional<Eigen::Isometry3d> PlaceOf(Measurements data, const Kinematics& setup, const Station& station,
                                         bool stands) {
  std::erase_if(data.stations, [&](const Station& each) { return each.name != station.name; });
  if (!stands || data.stations.empty()) data.stations = {station};
  const auto placed = StationsAt(data, setup);
  if (!placed.ok()) return std::nullopt;
  return placed->front().base_from_artifact;
}

void AddCheck(const Measurements& data, const Kinematics& before, const JointFit& fit, bool stands,
              Calibration* result) {
  const Kinematics after = fit.Found();
  for (const CheckLength& length : data.check) {
    result->check.names.push_back({length.name});
    result->check.u.push_back(length.u);
  }
  result->check.before = SpacingErrors(data, before);
  result->check.after = SpacingErrors(data, after);
  for (const Station& station : data.held_out) {
    result->check.names.push_back(Say(kHeldOut, station.name, station.views.size()));
    result->check.u.push_back(0);
    const auto add = [&](const Kinematics& setup, const std::optional<Eigen::Isometry3d>& place,
                         std::vector<double>* errors) {
      errors->push_back(place ? MeanDistance(data, setup, station, *place) : std::numeric_limits<double>::quiet_NaN());
    };
    add(before, PlaceOf(data, before, station, stands), &result->check.before);
    std::optional<Eigen::Isometry3d> place = PlaceOf(data, after, station, stands);
    for (size_t t = 0; stands && t < fit.stations.size(); ++t)
      if (fit.stations[t].name == station.name) place = fit.BaseFromArtifact(t);
    add(after, place, &result->check.after);
  }
}

}  // namespace

Result<Calibration> Scanner::Calibrate(const RefineChoice& choice) const {
  SCANCAL_RETURN_IF_ERROR(CheckOnlyResidual(choice, kResidual));
  SCANCAL_RETURN_IF_ERROR(CheckMonteCarlo(choice, !choice.equal_weights));
  const Stopwatch watch;
  const Result<ScreenedFit> screened =
      FitScreened(declaration_.data, model_, choice.max_iterations, choice.equal_weights);
  if (!screened.ok()) return InFile(declaration_.dataset, screened.error().message);
  const Measurements& data = screened->data;
  const JointFit& fit = screened->fit;
  std::vector<Sentence> warnings = declaration_.warnings;
  warnings.insert(warnings.end(), screened->warnings.begin(), screened->warnings.end());
  if (!fit.held.empty()) warnings.push_back(Say(kTermsHeld, fit.held.size(), Listed(fit.held)));
  const Refined refined{
      .solution = fit.solution, .residual = kResidual, .seconds = watch.Seconds(), .warnings = std::move(warnings)};
  Calibration result = Conclude(declaration_.dataset, refined, choice.monte_carlo);
  if (!fit.held_turn.empty()) result.notes.push_back(Say(kTurnHeld, Listed(fit.held_turn)));
  AddGeometry(fit, data.gravity, &result);
  AddTables(data, fit, &result);
  SCANCAL_ASSIGN_OR_RETURN(const Kinematics before,
                           data.measured_in_world ? InitialHandEye(data) : VirtualPointHandEye(data));
  AddCheck(data, before, fit, declaration_.held_out_stand, &result);
  Judge(*screened, &result);
  return result;
}

std::string Scanner::Describe() const {
  const Measurements& data = declaration_.data;
  size_t poses = 0, balls = 0;
  for (const Station& station : data.stations) {
    poses += station.views.size();
    for (const Model::View& pose : station.views) balls += pose.balls.size();
  }
  const std::string arm =
      data.links.empty() ? "poses of the flange as given" : fmt::format("an arm of {} joints", data.links.size());
  const std::string echo =
      Said(declaration_.arm.couplings) + (declaration_.echo.empty() ? "" : " " + declaration_.echo + ".");
  if (data.measured_in_world)
    return Opening(declaration_.dataset, "robot seen by a tracker, " + arm) +
           fmt::format("; {} poses, {} sights of {} on the flange; {} poses held out.", poses, balls,
                       data.spheres.size() == 1 ? "one point" : fmt::format("{} points", data.spheres.size()),
                       data.held_out.empty() ? 0 : data.held_out.front().views.size()) +
           echo;
  return Opening(declaration_.dataset, "robot with a scanner, " + arm) +
         fmt::format("; {} stations, {} poses, {} ball centres of an artifact of {} balls{}.", data.stations.size(),
                     poses, balls, data.spheres.size(),
                     data.check.empty() ? "" : fmt::format("; {} known lengths for a check", data.check.size())) +
         echo;
}

Result<std::unique_ptr<scancal::Scanner>> Load(const Dataset& dataset) {
  SCANCAL_ASSIGN_OR_RETURN(Declaration declaration, Declare(dataset));
  SCANCAL_ASSIGN_OR_RETURN(Model model, DeclareModel(declaration));
  return std::unique_ptr<scancal::Scanner>(std::make_unique<Scanner>(std::move(declaration), std::move(model)));
}

}  // namespace scancal::robot_ball
