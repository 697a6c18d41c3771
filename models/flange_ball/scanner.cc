#include "models/flange_ball/scanner.h"
#include <fmt/format.h>
#include <cmath>
#include "models/chain/tables.h"
#include "solver/uncertainty/jackknife.h"
#include "solver/weigh.h"

namespace scancal::flange_ball {
namespace {

constexpr Message<double, std::string_view, std::string_view, std::string_view> kBallNearAxis{
    "flange_ball.ball_near_axis",
    "the ball lies {:.2g} mm from the axis of the last joint: {} and ball_z are hardly determined one by one, only "
    "where the ball is; hold theta_{} and alpha_{}, or give priors",
    "Die Kugel liegt {:.2g} mm neben der Achse des letzten Gelenks: {} und ball_z sind einzeln kaum bestimmt, nur der "
    "Ort der Kugel; theta_{} und alpha_{} festhalten oder Vorwissen angeben"};
constexpr Message<double, double, double, double> kHeldOutStrays{
    "flange_ball.held_out_strays",
    "at the locations held out the ball strays by {:.3g} mm on average, where {:.3g} mm did in calibration: {:.2g} "
    "times "
    "what u and the noise explain (p = {:.1g}): the model lacks something there, and U does not hold it; calibrate "
    "with "
    "more locations of the tool",
    "An den zurückgehaltenen Orten streut die Kugel im Mittel um {:.3g} mm, bei der Kalibrierung um {:.3g} mm: das "
    "{:.2g}-Fache dessen, was u und das Rauschen erklären (p = {:.1g}): Dem Modell fehlt dort etwas, das U nicht "
    "enthält; "
    "mit mehr Orten des Werkzeugs kalibrieren"};
constexpr Message<std::string_view> kSpacingAt{"flange_ball.spacing_at", "spacing at {}", "Pfannenabstand an {}"};
constexpr Message<> kNominalFitted{"flange_ball.nominal_fitted", "nominal, ball fitted", "nominell, Kugel angepasst"};
constexpr Message<> kRefined{"flange_ball.refined", "refined", "verfeinert"};

constexpr char kResidual[] = "ball in socket";

double Poses(const std::vector<Model::Target>& tools) {
  double poses = 0;
  for (const Model::Target& tool : tools) poses += static_cast<double>(tool.views.size());
  return poses;
}

double MeanSpread(const Robot& robot, const std::vector<Model::Target>& tools) {
  double sum = 0;
  for (const Model::Target& tool : tools) sum += SeatingOf(robot, tool).spread;
  return sum / static_cast<double>(tools.size());
}

// Largest error of the sockets' distance.
double WorstSpacing(const Robot& robot, const std::vector<Model::Target>& tools, double spacing) {
  double worst = 0;
  for (const Model::Target& tool : tools) worst = std::max(worst, std::abs(SeatingOf(robot, tool).spacing - spacing));
  return worst;
}

std::map<std::string, std::vector<double>> GeometryOf(const Robot& robot, const Model::Target& tool) {
  const Seating seating = SeatingOf(robot, tool);
  const Eigen::Vector3d socket = robot.Socket(tool, 0);
  return {{"spread", {seating.spread}}, {"spacing", {seating.spacing}}, {"socket", {socket[0], socket[1], socket[2]}}};
}

Result<std::vector<Model::Target>> ReadTools(const std::vector<ToolDeclaration>& tools,
                                             const Declaration& declaration) {
  std::vector<Model::Target> targets;
  for (const ToolDeclaration& tool : tools) {
    SCANCAL_ASSIGN_OR_RETURN(targets.emplace_back(), ReadTool(tool, declaration));
  }
  return targets;
}

// Of every location of the tool: residual tables "poses" (with the number of the socket and the rms of the residual's
// coordinates) and "balls" (one a pose, the residual of Model: in the base, turned back by theta_1), and the scene
// in the base: "outline", the two sockets, and "views", from the flange to the ball. Parameters get their nominal
// number.
void AddTables(const std::vector<Link>& nominal, const std::vector<Model::Target>& tools, const Solution& solution,
               Calibration* calibration) {
  const Robot robot = RobotOf(nominal, solution);
  for (size_t t = 0; t < tools.size(); ++t) {
    const std::vector<Eigen::VectorXd> residuals = ResidualsOf(solution, t);
    NumberTable poses = PoseTable(nominal.size(), {{"socket", Unit::kOne}, {"rms", Unit::kMm}}),
                balls = PointResidualTable(), outline = PointTable(), views = SightTable();
    for (size_t v = 0; v < tools[t].views.size(); ++v) {
      const Model::View& view = tools[t].views[v];
      const Eigen::Vector3d r = residuals[v], flange = robot.FlangeAt(view).translation();
      AddPose(view.joints, flange, {static_cast<double>(view.socket), r.norm() / std::sqrt(3.0)}, &poses);
      balls.rows.push_back({static_cast<double>(v), r[0], r[1], r[2]});
      AddSight(flange, robot.InBase(view), &views);
    }
    for (const int socket : {0, 1}) AddPoint(robot.Socket(tools[t], socket), &outline);
    calibration->targets[t].residual_tables = {{"poses", poses}, {"balls", balls}};
    calibration->targets[t].scene = {{"outline", outline}, {"views", views}};
  }
  AddNominal(nominal, calibration);
}

// Warns of a ball so near to the last joint's axis that the link before is known to a few mm only. On the axis the last
// joint has no say, and the link before must place a mere point: three of its four numbers and the ball's height do
// that together.
void JudgeBall(const Robot& robot, Calibration* calibration) {
  constexpr double kNearAxis_mm = 5;
  const std::string before = std::to_string(robot.links.size() - 1);
  const double from_axis = robot.ball.head<2>().norm();
  if (from_axis > kNearAxis_mm || robot.links.size() < 2) return;
  std::string free;
  for (const char* name : {"theta_", "d_", "a_", "alpha_"}) {
    const Parameter* parameter = calibration->Find(name + before);
    if (!parameter || parameter->role != Role::kEstimate) return;
    free += (free.empty() ? "" : ", ") + parameter->name;
  }
  calibration->warnings.push_back(Say(kBallNearAxis, from_axis, free, before, before));
}

// Unreliable: the ball strays farther where the tool was held out than u and the noise explain.
void JudgeHeldOut(const Robot& robot, const Solution& solution, Model model, const std::vector<Model::Target>& tools,
                  std::vector<Model::Target> held_out, Calibration* calibration) {
  if (held_out.empty() || !(calibration->noise_dof >= 1)) return;
  const double spread = MeanSpread(robot, tools), strays = MeanSpread(robot, held_out);
  std::vector<std::vector<double>> values;
  for (Model::Target& tool : held_out) {
    Model::SetDirection(robot.Socket(tool, 1) - robot.Socket(tool, 0), &tool);
    values.push_back(Values(solution.problem, solution.fit.estimate, 0));
    Eigen::Vector3d::Map(&values.back()[Model::kSocket]) = robot.Socket(tool, 0);
    values.back()[Model::kDirection] = values.back()[Model::kDirection + 1] = 0;
  }
  for (size_t k = 0; k < solution.problem.quantities.size(); ++k)
    model.quantity(static_cast<int>(k)) = solution.problem.quantities[k];
  Problem problem = MakeProblem(std::make_shared<const Model>(model), std::move(held_out));
  Estimate at = NominalStart(problem);
  for (size_t t = 0; t < values.size(); ++t) SetValues(problem, values[t], t, &at);
  Weigh(&problem, at);
  const HeldOutTest test = TestHeldOut(problem, at, calibration->covariance, calibration->noise_dof);
  if (test.Contradicts())
    calibration->unreliable.push_back(Say(kHeldOutStrays, strays, spread, std::sqrt(test.F), test.p));
}

}  // namespace

Scanner::Scanner(Declaration declaration, std::vector<Model::Target> targets, std::vector<Model::Target> check)
    : declaration_(std::move(declaration)), targets_(std::move(targets)), check_(std::move(check)) {}

std::string Scanner::Describe() const {
  return Opening(declaration_.dataset, fmt::format("flange-ball, {} joints", declaration_.model.links().size())) +
         fmt::format("; sockets {:g} mm apart; {} locations of the tool with {} poses, {} more with {} poses held out.",
                     Spacing(), targets_.size(), Poses(targets_), check_.size(), Poses(check_)) +
         Said(declaration_.arm.couplings);
}

std::vector<std::filesystem::path> Scanner::Files() const { return declaration_.Files(); }

double Scanner::Spacing() const { return declaration_.model.quantities()[Model::kSpacing].value; }

Result<Solution> Scanner::Fit(const RefineChoice& choice) const {
  SCANCAL_ASSIGN_OR_RETURN(Solution solution, FitJointly(declaration_.model, targets_, choice.max_iterations));
  if (choice.equal_weights) return solution;
  return SolveWeighted(solution, kLeastSigma_mm, {choice.max_iterations});
}

Result<Calibration> Scanner::Calibrate(const RefineChoice& choice) const {
  SCANCAL_RETURN_IF_ERROR(CheckOnlyResidual(choice, kResidual));
  SCANCAL_RETURN_IF_ERROR(CheckMonteCarlo(choice, !choice.equal_weights));
  const Stopwatch watch;
  SCANCAL_ASSIGN_OR_RETURN(const Solution solution, Fit(choice));
  const Refined refined{.solution = solution, .residual = kResidual, .seconds = watch.Seconds()};
  Calibration result = Conclude(declaration_.dataset, refined, choice.monte_carlo);
  const Robot nominal = FitBall(declaration_.model.links(), targets_),
              robot = RobotOf(declaration_.model.links(), solution);
  for (size_t t = 0; t < targets_.size(); ++t) result.targets[t].geometry = GeometryOf(robot, targets_[t]);
  for (const Model::Target& tool : check_) {
    result.check.names.push_back(Say(kSpacingAt, tool.name));
    result.check.before.push_back(SeatingOf(nominal, tool).spacing - Spacing());
    result.check.after.push_back(SeatingOf(robot, tool).spacing - Spacing());
    result.check.u.push_back(declaration_.model.quantities()[Model::kSpacing].u);
  }
  AddTables(declaration_.model.links(), targets_, solution, &result);
  JudgeBall(robot, &result);
  JudgeHeldOut(robot, solution, declaration_.model, targets_, check_, &result);
  return result;
}

Result<Comparison> Scanner::Compare(const CompareChoice&) const {
  SCANCAL_ASSIGN_OR_RETURN(const Solution solution, Fit({}));
  Comparison comparison;
  comparison.columns = {{"calibrated with/mm"}, {"held out/mm"}, {"worst spacing/mm"}, {"worst, held out/mm"}};
  for (const auto* tools : {&targets_, &check_})
    for (const Model::Target& tool : *tools) comparison.columns.push_back({tool.name + "/mm"});
  const auto add = [&](const Sentence& method, const Robot& robot, const Sentence& note) {
    ComparisonRow& row = comparison.rows.emplace_back();
    row.method = method;
    row.note = note;
    row.cells = {{MeanSpread(robot, targets_)}, {}, {WorstSpacing(robot, targets_, Spacing())}, {}};
    if (!check_.empty()) {
      row.cells[1].value = MeanSpread(robot, check_);
      row.cells[3].value = WorstSpacing(robot, check_, Spacing());
    }
    for (const auto* tools : {&targets_, &check_})
      for (const Model::Target& tool : *tools) row.cells.push_back({SeatingOf(robot, tool).spread});
  };
  add(Say(kNominalFitted), FitBall(declaration_.model.links(), targets_), {});
  add(Say(kRefined), RobotOf(declaration_.model.links(), solution), solution.fit.message);
  return comparison;
}

Result<std::unique_ptr<scancal::Scanner>> Load(const Dataset& dataset) {
  SCANCAL_ASSIGN_OR_RETURN(Declaration declaration, Declare(dataset));
  SCANCAL_ASSIGN_OR_RETURN(std::vector<Model::Target> targets, ReadTools(declaration.targets, declaration));
  SCANCAL_ASSIGN_OR_RETURN(std::vector<Model::Target> check, ReadTools(declaration.check, declaration));
  return std::unique_ptr<scancal::Scanner>(
      std::make_unique<Scanner>(std::move(declaration), std::move(targets), std::move(check)));
}

}  // namespace scancal::flange_ball
