// Whether what a scan holds is one plane.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include "models/median.h"
#include "models/turntable/scanner.h"

namespace scancal::turntable {
namespace {

constexpr Message<std::string_view, double, double, double, double> kTwoPlanes{
    "turntable.two_planes",
    "target {}: the scan holds more than one plane: one fits its profiles to {:.2g} mm rms, but two, up to {:.0f} of "
    "its "
    "{:.0f} profiles (in the order of their angles) and from there on, to {:.2g} mm; crop it with keep, a target for "
    "each plane",
    "Prüfkörper {}: Der Scan enthält mehr als eine Ebene: Eine passt auf {:.2g} mm (quadratisches Mittel) zu seinen "
    "Profilen, zwei jedoch, bis zu {:.0f} seiner {:.0f} Profile (nach ihren Winkeln geordnet) und von da an, auf "
    "{:.2g} "
    "mm; mit keep zuschneiden, ein Prüfkörper je Ebene"};
constexpr Message<std::string_view, double, double, double> kTwoLines{
    "turntable.two_lines",
    "target {}: its profiles are two lines rather than one: one fits to {:.2g} mm rms, two to {:.2g} mm, {:.2g} mm "
    "apart "
    "where they meet; the scan holds more than one plane, an edge or a step: crop it with keep, a target for each "
    "plane",
    "Prüfkörper {}: Seine Profile sind eher zwei Geraden als eine: Eine passt auf {:.2g} mm (quadratisches Mittel), "
    "zwei "
    "auf {:.2g} mm, mit {:.2g} mm Abstand, wo sie sich treffen; der Scan enthält mehr als eine Ebene, eine Kante oder "
    "eine Stufe: mit keep zuschneiden, ein Prüfkörper je Ebene"};

// A profile as two lines, split between two of its segments where they fit best.
struct Split {
  double whole = 0, parts = 0;  // rms about one line, and about two, mm
  double apart = 0;             // of the two, along depth, where they meet
};

double DepthAt(const ProfileFactor& r, double z) {
  const double slope = r(1, 2) / r(1, 1), mean = r(0, 2) / r(0, 0);
  return mean + slope * (z - r(0, 1) / r(0, 0));
}

std::optional<Split> BestSplit(const Profile& profile) {
  constexpr size_t kFewestSegments = 2;  // a side
  constexpr double kFewestPoints = 20;
  const auto& segments = profile.segments;
  if (profile.count < kFewestPoints || segments.size() < 2 * kFewestSegments) return std::nullopt;
  const auto part = [&](size_t from, size_t to) {
    return MakeProfile(profile.alpha, 0,
                       {segments.begin() + static_cast<std::ptrdiff_t>(from),
                        segments.begin() + static_cast<std::ptrdiff_t>(to)},
                       std::nullopt)
        .factor;
  };
  const auto rms = [&](double sum) { return std::sqrt(sum / profile.count); };
  Split best{rms(std::pow(profile.factor(2, 2), 2)), std::numeric_limits<double>::infinity(), 0};
  for (size_t k = kFewestSegments; k + kFewestSegments <= segments.size(); ++k) {
    const ProfileFactor low = part(0, k), high = part(k, segments.size());
    const double left = rms(std::pow(low(2, 2), 2) + std::pow(high(2, 2), 2));
    const double meet = (segments[k - 1](0, 1) / segments[k - 1](0, 0) + segments[k](0, 1) / segments[k](0, 0)) / 2;
    if (left < best.parts) best = {best.whole, left, DepthAt(high, meet) - DepthAt(low, meet)};
  }
  return best;
}

}  // namespace

// Within the profiles: two lines that do not meet, or that fit so much better that no bend does it.
void JudgeProfiles(const std::vector<Placement>& placements, Calibration* calibration) {
  constexpr size_t kMost = 50, kFewest = 10;
  constexpr double kApart = 4;      // times what is left of the points; two lines through a bend meet
  constexpr double kOfBend = 0.17;  // what two lines leave of a parabola's rms: a quarter
  for (const Placement& placement : placements) {
    if (placement.IsLidar()) continue;
    std::vector<double> whole, parts, apart;
    const size_t n = std::min(kMost, placement.profiles.size());
    for (size_t k = 0; k < n; ++k) {
      const auto split = BestSplit(placement.profiles[k * placement.profiles.size() / n]);
      if (!split) continue;
      whole.push_back(split->whole);
      parts.push_back(split->parts);
      apart.push_back(split->apart);
    }
    if (whole.size() < kFewest) continue;
    const double one = Median(whole), two = Median(parts), gap = std::abs(Median(apart));
    if (gap > kApart * two || two < kOfBend * one)
      calibration->unreliable.insert(calibration->unreliable.begin(), Say(kTwoLines, placement.name, one, two, gap));
  }
}

// From profile to profile: two planes that the sweep goes over one after the other.
void JudgePlanes(const std::vector<Placement>& placements, const System& system, Calibration* calibration) {
  constexpr double kFarAboveNoise = 5, kExplained = 0.1;  // a plane that is bent by a wrong model leaves a quarter
  constexpr size_t kFewest = 20;
  for (const Placement& placement : placements) {
    const size_t n = placement.profiles.size();
    const double whole = PlaneStorey(placement.profiles, system).Rmse(system.M(), system.N(), PlaneFit::kOrthogonal);
    if (n < kFewest || !(whole > kFarAboveNoise * placement.Pure().sigma())) continue;
    std::vector<Profile> ordered = placement.profiles;
    std::stable_sort(ordered.begin(), ordered.end(), [](const auto& a, const auto& b) { return a.alpha < b.alpha; });
    const auto squares = [&](size_t from, size_t to) {
      const std::vector<Profile> part(ordered.begin() + static_cast<std::ptrdiff_t>(from),
                                      ordered.begin() + static_cast<std::ptrdiff_t>(to));
      double points = 0;
      for (const Profile& profile : part) points += profile.count;
      return points * std::pow(PlaneStorey(part, system).Rmse(system.M(), system.N(), PlaneFit::kOrthogonal), 2);
    };
    // The places that are tried come nearer to the best so far.
    size_t best = n / 2;
    double least = squares(0, best) + squares(best, n);
    for (size_t step = n / 8; step > 0; step /= 2) {
      const size_t middle = best;
      for (size_t at = middle > 4 * step ? middle - 3 * step : step; at < std::min(n - 1, middle + 4 * step);
           at += step) {
        if (at < 2 || at + 2 > n) continue;
        const double sum = squares(0, at) + squares(at, n);
        if (sum < least) {
          least = sum;
          best = at;
        }
      }
    }
    const double apart = std::sqrt(least / placement.Points());
    if (apart < kExplained * whole)
      calibration->unreliable.insert(
          calibration->unreliable.begin(),
          Say(kTwoPlanes, placement.name, whole, static_cast<double>(best), static_cast<double>(n), apart));
  }
}

}  // namespace scancal::turntable
