// What a scan holds that no measurement gives: copies, an undeclared mark of missing points, angles that were rounded.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include "models/line/robust_line.h"
#include "models/median.h"
#include "models/turntable/compress.h"
#include "solver/parallel.h"

namespace scancal::turntable {
namespace {

constexpr Message<std::string_view, double, double> kCopiedProfiles{
    "turntable.copied_profiles",
    "target {}: {:g} of its {:g} profiles are copies of others, point by point: copies bring no information, and each "
    "is "
    "counted once",
    "Prüfkörper {}: {:g} seiner {:g} Profile sind Punkt für Punkt Kopien anderer. Kopien bringen keine Information; "
    "jedes zählt einmal"};
constexpr Message<std::string_view, double> kCopiedPoints{
    "turntable.copied_points",
    "target {}: {:g} of its points are copies of others: copies bring no information, and each is counted once",
    "Prüfkörper {}: {:g} seiner Punkte sind Kopien anderer. Kopien bringen keine Information; jeder zählt einmal"};
constexpr Message<std::string_view, std::string_view> kCopiedTarget{
    "turntable.copied_target",
    "target {} is a copy of target {}, point by point: copies bring no information, and it is left out",
    "Prüfkörper {} ist Punkt für Punkt eine Kopie von {}. Kopien bringen keine Information; er bleibt außer Betracht"};
constexpr Message<std::string_view, double, double, double> kRoundedAngles{
    "turntable.rounded_angles",
    "target {}: its angles come in steps of {:.3g} deg, and {:g} profiles were taken at {:g} of them while it turned: "
    "each counts by itself, with an error of the angle of up to half a step (encoder_jitter); write the angle with "
    "more "
    "digits",
    "Prüfkörper {}: Seine Winkel kommen in Schritten von {:.3g}°, und {:g} Profile wurden bei {:g} davon während der "
    "Drehung aufgenommen: Jedes zählt für sich, mit einer Winkelabweichung bis zu einem halben Schritt "
    "(encoder_jitter). Den Winkel mit mehr Stellen schreiben"};

constexpr size_t kFewestAlike = 5;
constexpr double kImprobable = 40;        // nats
constexpr double kMostlyAlike = 0.9;      // of the points of the smaller of two profiles
constexpr double kOfNoise = 0.02;         // a difference that is nothing, of the noise
constexpr double kSameAngle = 2e-4;       // rad: a copy may be rounded
constexpr double kSpacing = 0.02;         // of the usual distance along z
constexpr double kLeastOfTarget = 0.2;    // of its profiles, or it is a copy as a whole
constexpr double kLeastDuplicates = 0.4;  // of the points of a profile

const std::vector<double>& Measured(const RawProfile& profile) {
  return profile.range.empty() ? profile.y : profile.range;
}

// The largest power of ten, at most 1, of which all values are multiples; 1e-6 of none.
double DecimalStep(const std::vector<double>& values) {
  for (double step = 1; step > 2e-6; step /= 10) {
    const bool all = std::all_of(values.begin(), values.end(), [&](double value) {
      return std::abs(value / step - std::round(value / step)) < 1e-3 + 1e-7 * std::abs(value / step);
    });
    if (all) return step;
  }
  return 1e-6;
}

// The steps in which a scan says depth (range), of some of its profiles, mm.
double StepOf(const std::vector<RawProfile>& profiles) {
  constexpr size_t kProfiles = 16;
  std::vector<double> sample;
  for (size_t k = 0; k < std::min(kProfiles, profiles.size()); ++k) {
    const std::vector<double>& of = Measured(profiles[k * profiles.size() / std::min(kProfiles, profiles.size())]);
    sample.insert(sample.end(), of.begin(), of.end());
  }
  return std::max(DecimalStep(sample), Resolution(sample));
}

// How improbable it is that independent readings of one place are as alike as `within`, in nats a point; 0: it is not.
// sigma: of a reading, its rounding to `step` among it. Readings that hardly scatter at their step repeat themselves.
double Improbability(double sigma, double step, double within) {
  const double square = sigma * sigma - step * step / 12;
  if (!(square > step * step / 4)) return 0;
  // |N(0, 2 sigma^2)| <= within + step / 2
  const double p = std::erf((within + step / 2) / (2 * std::sqrt(square)));
  return std::max(0.0, -std::log(p));
}

// Of a share `alike` of n points: with room for those that are not.
bool IsImprobable(double alike, double n, double nats) {
  return alike >= kMostlyAlike * n && n >= kFewestAlike && alike * nats - 0.33 * n >= kImprobable;
}

struct Alike {
  double same = 0, of = 0;
};

// Points of two profiles at the same z, both in its order.
Alike Matches(const RawProfile& a, const RawProfile& b, double within) {
  const std::vector<double>&y = Measured(a), &w = Measured(b);
  const double n = static_cast<double>(std::min(a.z.size(), b.z.size()));
  const double near =
      kSpacing * std::abs(a.z.back() - a.z.front()) / std::max(1.0, static_cast<double>(a.z.size() - 1));
  Alike alike{0, n};
  double seen = 0;
  for (size_t i = 0, j = 0; i < a.z.size() && j < b.z.size();) {
    if (a.z[i] < b.z[j] - near) {
      ++i;
    } else if (b.z[j] < a.z[i] - near) {
      ++j;
    } else {
      ++seen;
      alike.same += std::abs(y[i++] - w[j++]) <= within;
    }
    if (seen == 16 && alike.same < 8) return {0, n};
  }
  return alike;
}

// The same of profiles whose points are gone: all their numbers, to rounding.
bool SameNumbers(const Profile& a, const Profile& b) {
  if (a.count != b.count || a.segments.size() != b.segments.size() || a.count < kFewestAlike) return false;
  if (!(a.pure_error.sum_of_squares > 0)) return false;
  for (size_t k = 0; k < a.segments.size(); ++k)
    if (!a.segments[k].isApprox(b.segments[k], 1e-12)) return false;
  return true;
}

struct Place {
  size_t scan, profile;
};

double Sigma(const Profile& profile) { return profile.pure_error.sigma(); }

bool IsCopy(const RawScan& a, size_t i, const RawScan& b, size_t j) {
  if (!a.holds_points || !b.holds_points) return SameNumbers(a.compressed[i], b.compressed[j]);
  const double sigma = std::max(Sigma(a.compressed[i]), Sigma(b.compressed[j]));
  // One of the two may have been written with fewer digits.
  const double of_a = DecimalStep(Measured(a.profiles[i])), of_b = DecimalStep(Measured(b.profiles[j]));
  const double step = std::max({of_a, of_b, a.step, b.step});
  const double within = std::max(of_a == of_b ? 0 : step, kOfNoise * sigma) * (1 + 1e-9);
  const double nats = Improbability(sigma, step, within);
  if (nats == 0 || a.profiles[i].z.empty() || b.profiles[j].z.empty()) return false;
  const Alike alike = Matches(a.profiles[i], b.profiles[j], within);
  return IsImprobable(alike.same, alike.of, nats);
}

void Erase(const std::vector<bool>& which, RawScan* scan) {
  size_t k = 0;
  std::erase_if(scan->compressed, [&](const Profile&) { return which[k++]; });
  k = 0;
  if (scan->holds_points) std::erase_if(scan->profiles, [&](const RawProfile&) { return which[k++]; });
}

// Points that stand twice in their profile.
double DropCopiedPoints(RawScan* scan) {
  const auto duplicates = [&](const RawProfile& profile) {
    std::vector<bool> same(profile.z.size());
    const std::vector<double>& y = Measured(profile);
    const double near = kSpacing * std::abs(profile.z.back() - profile.z.front()) / static_cast<double>(same.size());
    for (size_t i = 1, kept = 0; i < same.size(); ++i) {
      same[i] = profile.z[i] - profile.z[kept] <= near && std::abs(y[i] - y[kept]) <= scan->step * (1 + 1e-9);
      if (!same[i]) kept = i;
    }
    return same;
  };
  double dropped = 0;
  for (size_t k = 0; k < scan->profiles.size(); ++k) {
    RawProfile& profile = scan->profiles[k];
    if (profile.z.size() < 2 * kFewestAlike) continue;
    const std::vector<bool> same = duplicates(profile);
    const double n = static_cast<double>(same.size()),
                 found = static_cast<double>(std::count(same.begin(), same.end(), true));
    const double nats = Improbability(Sigma(scan->compressed[k]), scan->step, scan->step);
    if (found < kLeastDuplicates * n || found * nats < kImprobable) {
      if (k == 0) return 0;  // it is all of them or none
      continue;
    }
    for (auto* column : {&profile.y, &profile.z, &profile.range}) {
      size_t i = 0;
      std::erase_if(*column, [&](double) { return same[i++]; });
    }
    const double time = scan->compressed[k].time, temperature = scan->compressed[k].temperature;
    scan->compressed[k] = CompressProfile(profile.alpha, profile.y, profile.z, profile.range);
    scan->compressed[k].time = time;
    scan->compressed[k].temperature = temperature;
    dropped += found;
  }
  return dropped;
}

// The value that stands in most profiles for the same reading of depth (range); see RepeatedValue.
double Mode(std::vector<double> values, size_t* count) {
  std::sort(values.begin(), values.end());
  double mode = 0;
  *count = 0;
  for (size_t i = 0, j = 0; i < values.size(); i = j) {
    while (j < values.size() && values[j] == values[i]) ++j;
    if (j - i > *count) {
      *count = j - i;
      mode = values[i];
    }
  }
  return mode;
}

// Where in a profile, in the order of the file, the line begins anew: along z, or along the bearing.
std::vector<size_t> Beginnings(const RawProfile& profile) {
  std::vector<double> along(profile.z.size());
  for (size_t i = 0; i < along.size(); ++i)
    along[i] = profile.range.empty() ? profile.z[i] : std::atan2(profile.z[i], profile.y[i]);
  const auto [low, high] = std::minmax_element(along.begin(), along.end());
  const double half = (*high - *low) / 2;
  std::vector<size_t> first = {0};
  for (size_t i = 1; i < along.size(); ++i)
    if (std::abs(along[i] - along[i - 1]) > half) first.push_back(i);
  for (size_t k = 0; k < first.size(); ++k) {
    const size_t end = k + 1 < first.size() ? first[k + 1] : along.size();
    if (end - first[k] < kFewestAlike || std::abs(along[end - 1] - along[first[k]]) < half) return {0};
  }
  return first;
}

RawProfile Part(const RawProfile& profile, size_t from, size_t to) {
  RawProfile part{profile.key, profile.alpha, {}, {}, {}, profile.time, profile.temperature};
  for (const auto column : {&RawProfile::y, &RawProfile::z, &RawProfile::range})
    if (const std::vector<double>& of = profile.*column; !of.empty())
      (part.*column)
          .assign(of.begin() + static_cast<std::ptrdiff_t>(from), of.begin() + static_cast<std::ptrdiff_t>(to));
  return part;
}

// How far apart the lines lie in the middle of the profile, over what their noise explains.
double Apart(const std::vector<RawProfile>& parts) {
  double low = 0, high = 0, noise = 0, extent = 0;
  for (size_t k = 0; k < parts.size(); ++k) {
    const RobustLine line = FitRobustLine(parts[k].y, parts[k].z);
    const double away = line.Distance(parts[0].y[parts[0].y.size() / 2], parts[0].z[parts[0].z.size() / 2]);
    low = k == 0 ? away : std::min(low, away);
    high = k == 0 ? away : std::max(high, away);
    noise = std::max(noise, line.scale / std::sqrt(static_cast<double>(parts[k].y.size())));
    extent = std::max(extent, std::abs(parts[k].z.back() - parts[k].z.front()));
  }
  return (high - low) / std::max(noise, 1e-9 * extent);
}

}  // namespace

std::optional<double> RepeatedValue(const std::vector<RawProfile>& profiles) {
  constexpr size_t kMost = 64;
  constexpr double kLeastShare = 0.01, kNear = 10, kNeighbours = 0.1;
  std::map<double, size_t> modes;
  const size_t n = std::min(kMost, profiles.size());
  std::vector<const RawProfile*> some;
  for (size_t k = 0; k < n; ++k) some.push_back(&profiles[k * profiles.size() / n]);
  if (n < kFewestAlike) return std::nullopt;
  for (const RawProfile* profile : some) {
    size_t count = 0;
    const double mode = Mode(Measured(*profile), &count);
    if (count >= 3) ++modes[mode];
  }
  const auto most = std::max_element(modes.begin(), modes.end(), [](auto& a, auto& b) { return a.second < b.second; });
  if (most == modes.end() || 2 * most->second <= n) return std::nullopt;
  // A surface crosses the steps beside one, too.
  const double value = most->first, step = StepOf(profiles);
  double points = 0, same = 0, beside = 0;
  for (const RawProfile* profile : some) {
    for (const double each : Measured(*profile)) {
      ++points;
      same += each == value;
      beside += each != value && std::abs(each - value) <= kNear * step;
    }
  }
  // A scan that is nothing else would be a plane, seen from everywhere at one distance.
  if (same < kLeastShare * points || beside > kNeighbours * same || same == points) return std::nullopt;
  return value;
}

void SplitAtRoundedAngles(RawScan* scan) {
  std::vector<RawProfile>& profiles = scan->profiles;
  std::vector<std::vector<size_t>> first(profiles.size());
  InParallel(profiles.size(), 0, [&](size_t k) { first[k] = Beginnings(profiles[k]); });
  if (!scan->turned_within_angles) {
    std::vector<double> apart;
    for (size_t k = 0; k < profiles.size(); ++k) {
      if (first[k].size() < 2) continue;
      std::vector<RawProfile> parts;
      for (size_t i = 0; i < first[k].size(); ++i)
        parts.push_back(
            Part(profiles[k], first[k][i], i + 1 < first[k].size() ? first[k][i + 1] : profiles[k].z.size()));
      apart.push_back(Apart(parts));
    }
    constexpr double kMoved = 8;  // standard deviations of a line's middle; standing still they are 2 to 4 apart
    if (apart.empty()) return;
    scan->turned_within_angles = Median(apart) > kMoved;
  }
  if (!*scan->turned_within_angles) return;
  std::vector<RawProfile> split;
  for (size_t k = 0; k < profiles.size(); ++k) {
    const double count = static_cast<double>(first[k].size());
    for (size_t i = 0; i < first[k].size(); ++i) {
      const size_t end = i + 1 < first[k].size() ? first[k][i + 1] : profiles[k].z.size();
      split.push_back(count > 1 ? Part(profiles[k], first[k][i], end) : std::move(profiles[k]));
      split.back().time += static_cast<double>(i) / count;
    }
  }
  profiles = std::move(split);
}

void NoteRoundedAngles(RawScan* scan) {
  if (!scan->turned_within_angles.value_or(false)) return;
  std::vector<double> alpha, gaps;
  for (const Profile& profile : scan->compressed) alpha.push_back(profile.alpha);
  std::sort(alpha.begin(), alpha.end());
  for (size_t k = 1; k < alpha.size(); ++k)
    if (alpha[k] - alpha[k - 1] > 1e-12) gaps.push_back(alpha[k] - alpha[k - 1]);
  scan->warnings.push_back(Say(kRoundedAngles, scan->name, Median(gaps) / kDegree, static_cast<double>(alpha.size()),
                               static_cast<double>(gaps.size() + 1)));
}

void Unwind(std::vector<RawScan>* scans) {
  constexpr double kTurn = 2 * std::numbers::pi;
  std::optional<double> middle;  // of the first scan
  for (RawScan& scan : *scans) {
    std::vector<double> alpha;
    for (const Profile& profile : scan.compressed) alpha.push_back(profile.alpha);
    if (alpha.empty()) continue;
    const auto [low, high] = std::minmax_element(alpha.begin(), alpha.end());
    double begin = *low;
    if (*high - *low > std::numbers::pi) {
      // On the circle the widest gap is where the plate is not seen.
      std::vector<double> on_circle;
      for (const double a : alpha) on_circle.push_back(a - kTurn * std::floor(a / kTurn));
      std::sort(on_circle.begin(), on_circle.end());
      double widest = on_circle.front() + kTurn - on_circle.back();
      begin = on_circle.front();
      for (size_t k = 1; k < on_circle.size(); ++k) {
        if (on_circle[k] - on_circle[k - 1] <= widest) continue;
        widest = on_circle[k] - on_circle[k - 1];
        begin = on_circle[k];
      }
      if (widest < std::numbers::pi) continue;  // it is no wrap; CheckPlausible says so
      const double half = (kTurn - widest) / 2;
      begin -= kTurn * std::round((begin + half - middle.value_or(0)) / kTurn);
    } else if (middle) {
      begin -= kTurn * std::round(((*low + *high) / 2 - *middle) / kTurn);
    }
    const auto unwound = [&](double a) {
      if (a >= begin && a < begin + std::numbers::pi) return a;  // no rounding where nothing is to be done
      return a - kTurn * std::floor((a - begin) / kTurn + 1e-12);
    };
    double from = 1e300, to = -1e300;
    for (Profile& profile : scan.compressed) {
      profile.alpha = unwound(profile.alpha);
      from = std::min(from, profile.alpha);
      to = std::max(to, profile.alpha);
    }
    for (RawProfile& profile : scan.profiles) profile.alpha = unwound(profile.alpha);
    if (!middle) middle = (from + to) / 2;
  }
}

void DropCopies(std::vector<RawScan>* scans) {
  std::vector<Place> places;
  for (size_t s = 0; s < scans->size(); ++s) {
    RawScan& scan = (*scans)[s];
    scan.step = scan.holds_points ? StepOf(scan.profiles) : 0;
    if (scan.holds_points)
      if (const double copied = DropCopiedPoints(&scan); copied > 0) {
        scan.copied += copied;
        scan.warnings.push_back(Say(kCopiedPoints, scan.name, copied));
      }
    for (size_t k = 0; k < scan.compressed.size(); ++k) places.push_back({s, k});
  }
  const auto alpha = [&](const Place& p) { return (*scans)[p.scan].compressed[p.profile].alpha; };
  std::vector<std::vector<bool>> copied;
  for (const RawScan& scan : *scans) copied.emplace_back(scan.compressed.size());
  std::vector<std::map<size_t, double>> of(scans->size());  // which scans they are copies of
  std::vector<size_t> order(places.size());
  for (size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return alpha(places[a]) < alpha(places[b]); });
  for (size_t a = 0; a < order.size(); ++a) {
    for (size_t b = a + 1; b < order.size() && alpha(places[order[b]]) - alpha(places[order[a]]) <= kSameAngle; ++b) {
      const auto [first, later] = std::minmax(order[a], order[b]);
      const Place &p = places[first], &q = places[later];
      if (copied[q.scan][q.profile] || copied[p.scan][p.profile]) continue;
      if (!IsCopy((*scans)[p.scan], p.profile, (*scans)[q.scan], q.profile)) continue;
      copied[q.scan][q.profile] = true;
      ++of[q.scan][p.scan];
    }
  }
  for (size_t s = scans->size(); s-- > 0;) {
    RawScan& scan = (*scans)[s];
    const double all = static_cast<double>(scan.compressed.size());
    const double copies = static_cast<double>(std::count(copied[s].begin(), copied[s].end(), true));
    if (copies == 0) continue;
    const auto from =
        std::max_element(of[s].begin(), of[s].end(), [](auto& x, auto& y) { return x.second < y.second; });
    if (from->first != s && copies > (1 - kLeastOfTarget) * all) {
      (*scans)[from->first].warnings.push_back(Say(kCopiedTarget, scan.name, (*scans)[from->first].name));
      scans->erase(scans->begin() + static_cast<std::ptrdiff_t>(s));
      continue;
    }
    for (size_t k = 0; k < scan.compressed.size(); ++k)
      if (copied[s][k]) scan.copied += scan.compressed[k].count;
    Erase(copied[s], &scan);
    scan.warnings.push_back(Say(kCopiedProfiles, scan.name, copies, all));
  }
}

}  // namespace scancal::turntable
