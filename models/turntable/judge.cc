// What may go wrong with planes on a turntable.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include "io/message.h"
#include "models/median.h"
#include "models/turntable/scanner.h"

namespace scancal::turntable {
namespace {

constexpr Message<Sentence, std::string_view, double> kAddPlacement{
    "turntable.add_placement",
    "{}; {} suffers most (u = {:.2g} mm); add a placement with the plate turned about the vertical by 20 deg or more "
    "against the others",
    "{}; am meisten leidet {} (u = {:.2g} mm). Eine Aufstellung ergänzen, bei der die Platte gegen die übrigen um 20° "
    "oder mehr um die Senkrechte gedreht ist"};
constexpr Message<> kOnePlacement{"turntable.one_placement", "there is only one placement of the plate",
                                  "Es gibt nur eine Aufstellung der Platte"};
constexpr Message<double> kNormalsAlike{"turntable.normals_alike",
                                        "the normals of all placements lie within {:.2g} deg",
                                        "Die Normalen aller Aufstellungen liegen innerhalb von {:.2g}°"};
constexpr Message<double, double> kMinimumOnEdge{
    "turntable.minimum_on_edge",
    "the grid minimum M = {:g}, N = {:g} mm lies on the edge of the search interval; widen search in dataset.yaml",
    "Das Minimum der Gittersuche M = {:g} mm, N = {:g} mm liegt am Rand des Suchbereichs; search in dataset.yaml "
    "erweitern"};
constexpr Message<std::string_view, double> kMinimumApart{
    "turntable.minimum_apart",
    "{}: the grid minimum lies {:.3g} mm from the refined value, more than step and u explain: the noise pulls the "
    "search away, or the model lacks something",
    "{}: Das Minimum der Gittersuche liegt {:.3g} mm neben dem verfeinerten Wert, mehr, als Schrittweite und u "
    "erklären: Das Rauschen zieht die Suche weg, oder dem Modell fehlt etwas"};
constexpr Message<std::string_view, double> kOutsideSearch{
    "turntable.outside_search",
    "{} = {:.6g} mm lies outside the search interval; widen search in dataset.yaml, or look at the scans",
    "{} = {:.6g} mm liegt außerhalb des Suchbereichs; search in dataset.yaml erweitern oder die Scans ansehen"};
constexpr Message<std::string_view, size_t, size_t> kFewProfiles{
    "turntable.few_profiles",
    "target {}: {} profiles fit nearly any plane, so that nothing tells whether they are right; scan it at {} angles "
    "or "
    "more",
    "Prüfkörper {}: {} Profile passen zu fast jeder Ebene; ob sie richtig sind, zeigt daher nichts; bei mindestens {} "
    "Winkeln scannen"};
constexpr Message<double> kNarrowSweep{
    "turntable.narrow_sweep",
    "the sweep of {:.2g} deg is too narrow to tell M and N well: a wider one is the cheapest gain; if the file holds "
    "radians, declare angle: rad",
    "Der Drehbereich von {:.2g}° ist zu eng, um M und N gut zu bestimmen: Ein weiterer ist der billigste Gewinn; "
    "stehen in der Datei Radiant, so ist angle: rad anzugeben"};

constexpr Message<double, double, double, double> kMirrorImage{
    "turntable.mirror_image",
    "the search interval holds the mirror image, too: M = {:.6g}, N = {:.6g} mm if depth grows away from the sensor, "
    "but "
    "M = {:.6g}, N = {:.6g} mm if it is counted towards it (or is a height), and planes fit both alike; declare depth: "
    "away or depth: towards, or narrow search. (The other exact symmetry: with the other sense of rotation M is -M.)",
    "Der Suchbereich enthält auch das Spiegelbild: M = {:.6g} mm, N = {:.6g} mm, wenn die Tiefe vom Sensor weg wächst, "
    "aber M = {:.6g} mm, N = {:.6g} mm, wenn sie zum Sensor hin zählt (oder eine Höhe ist); Ebenen passen zu beidem "
    "gleich gut. depth: away oder depth: towards angeben oder search verengen. (Die andere genaue Symmetrie: Beim "
    "anderen "
    "Drehsinn wird M zu -M.)"};
constexpr Message<std::string_view, double, double, double> kGap{
    "turntable.gap",
    "target {}: its angles have a gap of {:.3g} deg, in which about {:.0f} of {:.0f} profiles are missing",
    "Prüfkörper {}: Seine Winkel haben eine Lücke von {:.3g}°, in der etwa {:.0f} von {:.0f} Profilen fehlen"};
constexpr Message<std::string_view, double, Sentence> kMuchSetAside{
    "turntable.much_set_aside",
    "target {}: {:.0f} % of its points were set aside, most {}: does the scan hold more than one plane? Crop it with "
    "keep",
    "Prüfkörper {}: {:.0f} % seiner Punkte blieben außer Betracht, die meisten davon {}: Enthält der Scan mehr als "
    "eine "
    "Ebene? Mit keep zuschneiden"};
constexpr Message<> kOffTheLine{"turntable.off_the_line", "off the line of their profile",
                                "abseits der Geraden ihres Profils"};
constexpr Message<> kOffThePlane{"turntable.off_the_plane", "off the plane of most", "abseits der Ebene der meisten"};

constexpr double kImplausibleLength_mm = 50e3;  // no plate is seen from farther away
constexpr double kPerpendicular = 1 * kDegree;  // a plate's normal nearer to the axis tells nothing of M and N
constexpr double kApart = 5 * kDegree;          // two placements are different
constexpr double kNarrow = 5 * kDegree;
constexpr size_t kFewestOfTarget = 4;
constexpr double kFarFromGrid = 5;  // of step and u
constexpr double kEdgeOn = 0.02;    // cosine of the incidence
constexpr double kMuch = 0.3;       // of the points set aside
constexpr double kWideGap = 10;     // of the usual step between profiles
constexpr double kOfSweep = 0.05;   // what a gap must be of it

// Smallest |n . d| over the profiles of a placement, d the direction along which the sensor measures.
double LeastIncidence(const Placement& placement, const System& system, const Eigen::Vector3d& normal) {
  double least = 1;
  for (const Profile& profile : placement.profiles) {
    const PseudoPoint p = PseudoPoints(profile.factor)[1];
    const ProfileInTable<double> at = system.At(profile.alpha);
    const Eigen::Vector3d sight =
        placement.IsLidar() ? Eigen::Vector3d(at.along_y * p.y + at.along_z * p.z) : at.along_y;
    least = std::min(least, std::abs(normal.dot(at.Turned(sight).normalized())));
  }
  return least;
}

// Largest angle between two normals, their signs aside.
double LargestAngle(const JointFit& fit) {
  double largest = 0;
  for (size_t i = 0; i < fit.targets.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      largest = std::max(largest, std::acos(std::min(1.0, std::abs(fit.Plane(i).first.dot(fit.Plane(j).first)))));
  return largest;
}

const Parameter* LeastKnownLength(const Calibration& calibration) {
  const Parameter* worst = nullptr;
  for (const Parameter& p : calibration.parameters)
    if (p.role == Role::kEstimate && p.unit == Unit::kMm && (!worst || p.u > worst->u)) worst = &p;
  return worst;
}

void JudgeOrientations(const JointFit& fit, Calibration* calibration) {
  const double angle = LargestAngle(fit);
  const Parameter* worst = LeastKnownLength(*calibration);
  if (angle >= kApart || !worst) return;
  const Sentence which = fit.targets.size() == 1 ? Say(kOnePlacement) : Say(kNormalsAlike, angle / kDegree);
  calibration->unreliable.push_back(Say(kAddPlacement, which, worst->name, worst->u));
}

void JudgeSearch(const GridBox& box, const GridNode& least, Calibration* calibration) {
  if (least.on_edge) calibration->unreliable.push_back(Say(kMinimumOnEdge, least.at[0], least.at[1]));
  for (const size_t k : {0, 1}) {
    const Parameter* p = calibration->Find(k == 0 ? "M" : "N");
    const double apart = std::abs(p->value - least.at[k]);
    if (p->role == Role::kEstimate && !least.on_edge && apart > kFarFromGrid * (box.step + p->u))
      calibration->unreliable.push_back(Say(kMinimumApart, p->name, apart));
    if (p->role == Role::kEstimate && (p->value < box.lower[k] || p->value > box.upper[k]) && !least.on_edge)
      calibration->unreliable.push_back(Say(kOutsideSearch, p->name, p->value));
  }
}

// Counts of an encoder: whole numbers, and many of them.
bool LooksLikeCounts(const Placement& placement, const Units& units) {
  constexpr double kMost = 1000;
  return placement.Sweep() > kMost * units.angle_in_rad &&
         std::all_of(placement.profiles.begin(), placement.profiles.end(), [&](const Profile& profile) {
           const double reading = profile.alpha / units.angle_in_rad;
           return std::abs(reading - std::round(reading)) < 1e-6;
         });
}

// A scan in radians among others in degrees.
Result<void> CheckOneInRadians(const std::vector<Placement>& placements) {
  constexpr double kAbout = 2.5;  // sweeps of one measurement are alike to this factor
  for (size_t t = 0; t < placements.size() && placements.size() > 1; ++t) {
    std::vector<double> others;
    for (size_t k = 0; k < placements.size(); ++k)
      if (k != t) others.push_back(placements[k].Sweep());
    const double own = placements[t].Sweep(), ratio = Median(others) * kDegree / std::max(own, 1e-300);
    if (ratio > 1 / kAbout && ratio < kAbout && own < Median(others))
      return Error{
          fmt::format("target {}: its angles span {:.4g} deg, but those of the others {:.4g} deg, about 57.3 times as "
                      "much: are they "
                      "radians? Name its column angle_rad; if they are right, a sweep as narrow as that tells nothing: "
                      "leave it out",
                      placements[t].name, own / kDegree, Median(others) / kDegree)};
  }
  return {};
}

// No depth at all, if no line explains it.
Result<void> CheckDepths(const std::vector<Placement>& placements) {
  constexpr double kNoLine = 0.3;  // of the range of depths
  for (const Placement& placement : placements) {
    const ScannedVolume volume = VolumeOf({placement});
    const double sigma = placement.Pure().sigma(), range = volume.y[1] - volume.y[0];
    std::vector<double> thickness;  // of a profile's points: across their line, over along it
    for (const Profile& profile : placement.profiles) {
      const Eigen::Matrix2d spread = profile.factor.bottomRightCorner<2, 2>();  // s t = |det|, s^2 + t^2 = |spread|^2
      const double squares = spread.squaredNorm(), product = std::abs(spread.determinant());
      const double s = std::sqrt((squares + std::sqrt(std::max(0.0, squares * squares - 4 * product * product))) / 2);
      thickness.push_back(product / std::max(s * s, 1e-24));
    }
    if (placement.Pure().dof > 100 && sigma > kNoLine * range && sigma > 1 && Median(thickness) > kNoLine)
      return Error{
          fmt::format("target {}: its depths scatter by {:.3g} mm about the lines of their profiles, which span {:.3g} "
                      "mm: that is no "
                      "plane; is the column y (or range) a depth, or an intensity?",
                      placement.name, sigma, range)};
  }
  return {};
}

// Profiles that are missing in the middle of a sweep, and points of which much was set aside.
void JudgeScans(const std::vector<Placement>& placements, Calibration* calibration) {
  for (const Placement& placement : placements) {
    std::vector<double> alpha, steps;
    for (const Profile& profile : placement.profiles) alpha.push_back(profile.alpha);
    std::sort(alpha.begin(), alpha.end());
    for (size_t k = 1; k < alpha.size(); ++k)
      if (alpha[k] > alpha[k - 1]) steps.push_back(alpha[k] - alpha[k - 1]);
    if (steps.size() > 10) {
      const double usual = Median(steps), widest = *std::max_element(steps.begin(), steps.end());
      const double all = placement.Sweep() / usual + 1;
      if (widest > kWideGap * usual && widest > kOfSweep * placement.Sweep())
        calibration->warnings.push_back(Say(kGap, placement.name, widest / kDegree, widest / usual - 1, all));
    }
    double aside = 0, most = 0;
    const Message<>* reason = &kOffTheLine;
    for (const auto& [why, count] : placement.set_aside) {
      if (why.starts_with("copies")) continue;
      aside += count;
      if (count > most) reason = why.find("plane") != std::string::npos ? &kOffThePlane : &kOffTheLine;
      most = std::max(most, count);
    }
    const double all = placement.Points() + aside;
    if (aside > kMuch * all)
      calibration->warnings.push_back(Say(kMuchSetAside, placement.name, 100 * aside / all, Say(*reason)));
  }
}

}  // namespace

void JudgeMirrorImage(bool depth_declared, const GridBox& box, const std::vector<Placement>& placements,
                      Calibration* calibration) {
  const Parameter *m = calibration->Find("M"), *n = calibration->Find("N");
  if (depth_declared || placements.front().IsLidar() || m->role != Role::kEstimate || n->role != Role::kEstimate)
    return;
  const std::array<double, 2> image = {-m->value, -n->value};
  for (const size_t k : {0, 1})
    if (image[k] < box.lower[k] || image[k] > box.upper[k]) return;
  if (std::abs(n->value) < box.step && std::abs(m->value) < box.step) return;  // hardly another
  calibration->unreliable.push_back(Say(kMirrorImage, m->value, n->value, image[0], image[1]));
}

Result<void> CheckPlausible(const std::vector<Placement>& placements, const Units& units) {
  double widest = 0, largest = 0;
  for (const Placement& placement : placements) {
    const double sweep = placement.Sweep();
    widest = std::max(widest, sweep);
    if (LooksLikeCounts(placement, units))
      return Error{fmt::format(
          "target {}: its angles span {:.6g} {} in whole numbers: are they counts of the encoder? Divide by the "
          "counts per turn, and give angles",
          placement.name, sweep / units.angle_in_rad, units.angle)};
    largest = std::max(largest, placement.largest);
    if (sweep > std::numbers::pi)
      return Error{
          fmt::format("target {}: its angles span {:.4g} rad ({:.4g} deg), but a plane is seen over less than half "
                      "a turn; is units: angle: {} right (degrees declared as rad?)",
                      placement.name, sweep, sweep / kDegree, units.angle)};
    if (placement.largest > kImplausibleLength_mm)
      return Error{
          fmt::format("target {}: found a coordinate of {:.4g} m, expected less than {:g} m; is units: length: {} "
                      "right (mm declared as m?)",
                      placement.name, placement.largest / 1000, kImplausibleLength_mm / 1000, units.length)};
  }
  if (largest < 1)
    return Error{
        fmt::format("the largest coordinate is {:.4g} mm, expected the size of a plate; is units: length: {} right "
                    "(m declared as mm, mm as um?)",
                    largest, units.length)};
  if (widest == 0)
    return Error{"M, N: not determined: every target has one angle only; the profiler must turn while it scans"};
  if (widest < kDegree)
    return Error{
        fmt::format("the angles span {:.3g} deg, expected more than one; if the file holds radians (a sweep of "
                    "{:.3g} deg), declare angle: rad",
                    widest / kDegree, widest / kDegree / kDegree)};
  SCANCAL_RETURN_IF_ERROR(CheckOneInRadians(placements));
  SCANCAL_RETURN_IF_ERROR(CheckDepths(placements));
  for (const Placement& placement : placements)
    if (placement.Sweep() == 0)
      return Error{fmt::format("target {}: its plane is not determined: it needs profiles at two angles or more",
                               placement.name)};
  return {};
}

Result<void> CheckOrientations(const Quantities& quantities, const std::vector<Placement>& placements,
                               const std::vector<PlaneStorey>& storeys, const System& system) {
  bool all_perpendicular = true;
  for (size_t t = 0; t < placements.size(); ++t) {
    const Eigen::Vector3d normal = storeys[t].FitPlane(system.M(), system.N()).first;
    all_perpendicular &= std::abs(normal.z()) > std::cos(kPerpendicular);
  }
  std::vector<std::string> names;
  for (const int k : {Model::kM, Model::kN})
    if (quantities[k].role == Role::kEstimate && quantities[k].u <= 0) names.push_back(quantities[k].name);
  if (all_perpendicular && !names.empty())
    return Error{Listed(names) +
                 ": not determined: every plate is perpendicular to the axis, and such a plane looks the same "
                 "for every offset; stand the plate up, 5 to 20 deg from the axis"};
  return {};
}

Result<void> CheckIncidence(const std::vector<Placement>& placements, const System& system) {
  for (const Placement& placement : placements) {
    const Eigen::Vector3d normal = PlaneStorey(placement.profiles, system).FitPlane(system.M(), system.N()).first;
    if (LeastIncidence(placement, system, normal) < kEdgeOn)
      return Error{
          "target " + placement.name +
          ": the sensor sees the plate edge-on, where depth tells nothing; narrow its keep: angle, or leave it out"};
  }
  return {};
}

Result<void> CheckDetermined(const JointFit& fit) {
  return scancal::CheckDetermined(
      fit.solution.observability,
      {"target", "its plane is not determined; it needs profiles at two angles or more", "these placements"});
}

void Judge(const GridBox& box, const std::vector<Placement>& placements, const GridResult& grid, const JointFit& fit,
           Calibration* calibration) {
  JudgeSearch(box, grid.best, calibration);
  JudgeOrientations(fit, calibration);
  JudgePlanes(placements, fit.Found().With(grid.best.at[0], grid.best.at[1]), calibration);
  JudgeProfiles(placements, calibration);
  JudgeScans(placements, calibration);
  double widest = 0;
  for (const Placement& placement : placements) widest = std::max(widest, placement.Sweep());
  for (const Placement& placement : placements)
    if (placement.profiles.size() < kFewestOfTarget)
      calibration->unreliable.push_back(Say(kFewProfiles, placement.name, placement.profiles.size(), kFewestOfTarget));
  if (widest < kNarrow) calibration->warnings.push_back(Say(kNarrowSweep, widest / kDegree));
}

}  // namespace scancal::turntable
