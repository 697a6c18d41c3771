#include "models/turntable/tables.h"
#include <glog/logging.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include "models/median.h"
#include "models/scanner.h"

namespace scancal::turntable {
namespace {

constexpr size_t kMostGroups = 120, kMostInSweep = 600, kMostLagsDrawn = 60;

struct Mean {
  double sum = 0, count = 0;
  void Add(double value, double times) {
    sum += value * times;
    count += times;
  }
  void Add(const Mean& other) {
    sum += other.sum;
    count += other.count;
  }
  double Value() const { return sum / count; }
};

struct Piece {  // a segment
  double z = 0;
  Mean residual;
};

// Each segment as a profile of its own.
std::vector<Profile> SegmentsOf(const std::vector<Profile>& profiles) {
  std::vector<Profile> pieces;
  for (const Profile& profile : profiles)
    for (const ProfileFactor& segment : profile.segments)
      pieces.push_back({profile.alpha, segment(0, 0) * segment(0, 0), {segment}, segment, profile.ranged, {}});
  return pieces;
}

// One point of weight one at the mean of the points.
std::vector<Model::View> CentresOf(const std::vector<Profile>& profiles) {
  std::vector<Model::View> views;
  for (const Profile& profile : profiles) {
    const double z = profile.factor(0, 1) / profile.factor(0, 0), y = profile.factor(0, 2) / profile.factor(0, 0);
    Model::View& view = views.emplace_back();
    view.alpha = profile.alpha;
    view.points = {{profile.ranged ? std::hypot(y, z) : 1, y, z}};
    view.along_range = profile.ranged.has_value();
  }
  return views;
}

// Per profile its segments.
std::vector<std::vector<Piece>> PiecesOf(const FittedPlacement& fitted) {
  const Seen<double> q{fitted.values.data(), nullptr, static_cast<int>(fitted.values.size())};
  const std::vector<Profile>& profiles = fitted.placement.profiles;
  const std::vector<Profile> segments = SegmentsOf(profiles);
  std::vector<Model::View> views = CentresOf(segments);
  if (fitted.system.Bends()) AddBend(fitted.system, segments, &views);
  // A segment moves as its profile does.
  size_t of = 0;
  for (size_t p = 0; p < profiles.size(); ++p)
    for (size_t k = 0; k < profiles[p].segments.size(); ++k, ++of) {
      views[of].motion = fitted.target.views[p].motion;
      views[of].line = Eigen::RowVector2d(views[of].points[0].weight, 0);
    }
  if (std::any_of(q.q + Model::kForm, q.q + Model::kForm + kFormModes, [](double form) { return form != 0; })) {
    const auto [normal, distance] = Model::Plane(fitted.target, Eigen::Vector3d::Map(q.q + Model::kNormal1));
    AddForm(segments, fitted.system, normal, distance, &views);
  }
  const Model model(Model::Residuals::kDepth);
  std::vector<std::vector<Piece>> pieces;
  size_t at = 0;
  for (const Profile& profile : profiles) {
    std::vector<Piece>& of_profile = pieces.emplace_back();
    for (size_t k = 0; k < profile.segments.size(); ++k, ++at) {
      double residual = 0;
      model.Residual(fitted.target, views[at], q, &residual);
      Piece& piece = of_profile.emplace_back();
      piece.z = views[at].points[0].z;
      piece.residual.Add(residual, segments[at].count);
    }
  }
  return pieces;
}

struct Group {  // of neighbouring profiles
  std::vector<size_t> profiles;
  double from = 0, to = 0;  // rad: to the middle of the gap to the next group, but no farther than a usual gap
};

// In the order of alpha; profiles at one angle are never apart.
std::vector<Group> InGroups(const std::vector<Profile>& profiles, size_t most) {
  std::vector<size_t> order(profiles.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return profiles[a].alpha < profiles[b].alpha; });
  std::vector<Group> angles;
  std::vector<double> gaps;
  for (const size_t k : order) {
    const double alpha = profiles[k].alpha;
    if (!angles.empty() && alpha > angles.back().to) gaps.push_back(alpha - angles.back().to);
    if (angles.empty() || alpha > angles.back().to) angles.push_back({{}, alpha, alpha});
    angles.back().profiles.push_back(k);
  }
  const double usual = gaps.empty() ? 0 : Median(gaps);
  std::vector<Group> groups;
  const size_t count = std::min(most, angles.size());
  for (size_t a = 0; a < angles.size(); ++a) {
    if (a * count / angles.size() == groups.size()) groups.push_back({{}, angles[a].from, 0});
    groups.back().profiles.insert(groups.back().profiles.end(), angles[a].profiles.begin(), angles[a].profiles.end());
    groups.back().to = angles[a].to;
  }
  double gap = usual;
  for (size_t g = 0; g < groups.size(); ++g) {
    groups[g].from -= gap / 2;
    gap = g + 1 < groups.size() ? std::min(groups[g + 1].from - groups[g].to, 2 * usual) : usual;
    groups[g].to += gap / 2;
  }
  return groups;
}

NumberTable CellTable(const FittedPlacement& fitted, const std::vector<std::vector<Piece>>& pieces) {
  const std::vector<Profile>& profiles = fitted.placement.profiles;
  double lowest = Ends(profiles.front().factor)[0].z, highest = lowest;
  size_t intervals = 1;
  for (const Profile& profile : profiles) {
    const auto [low, high] = Ends(profile.factor);
    lowest = std::min(lowest, low.z);
    highest = std::max(highest, high.z);
    intervals = std::max(intervals, profile.segments.size());
  }
  const double height = (highest - lowest) / static_cast<double>(intervals);
  const auto interval = [&](double z) {
    const double above = height > 0 ? std::max(0.0, (z - lowest) / height) : 0;
    return std::min(static_cast<size_t>(above), intervals - 1);
  };
  using enum Unit;
  NumberTable table = TableOf(
      {{"alpha_from", kRad}, {"alpha_to", kRad}, {"z_from", kMm}, {"z_to", kMm}, {"residual", kMm}, {"points", kOne}});
  for (const Group& group : InGroups(profiles, kMostGroups)) {
    std::vector<Mean> means(intervals);
    for (const size_t k : group.profiles)
      for (const Piece& piece : pieces[k]) means[interval(piece.z)].Add(piece.residual);
    for (size_t i = 0; i < intervals; ++i) {
      if (means[i].count == 0) continue;
      const double z = lowest + static_cast<double>(i) * height;
      table.rows.push_back({group.from, group.to, z, z + height, means[i].Value(), std::round(means[i].count)});
    }
  }
  return table;
}

NumberTable SweepTable(const FittedPlacement& fitted, const std::vector<Mean>& means) {
  NumberTable table = TableOf({{"alpha", Unit::kRad}, {"residual", Unit::kMm}, {"u", Unit::kMm}});
  const double sigma = fitted.placement.Pure().sigma();
  for (const Group& group : InGroups(fitted.placement.profiles, kMostInSweep)) {
    Mean alpha, residual;
    for (const size_t k : group.profiles) {
      alpha.Add(fitted.placement.profiles[k].alpha, means[k].count);
      residual.Add(means[k]);
    }
    table.rows.push_back({alpha.Value(), residual.Value(), sigma / std::sqrt(residual.count)});
  }
  return table;
}

// In the order of time. Empty of a sweep that never turns back: there it is the order of angles.
NumberTable TimeTable(const FittedPlacement& fitted, const std::vector<Mean>& means) {
  const std::vector<Profile>& profiles = fitted.placement.profiles;
  std::vector<size_t> order(profiles.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::stable_sort(order, {}, [&](size_t k) { return profiles[k].time; });
  if (profiles[order.front()].time == profiles[order.back()].time) return {};  // not known
  const auto alpha = [&](size_t k) { return profiles[k].alpha; };
  if (std::ranges::is_sorted(order, {}, alpha) || std::ranges::is_sorted(order, std::greater(), alpha)) return {};
  NumberTable table = TableOf({{"time", Unit::kOne}, {"alpha", Unit::kRad}, {"residual", Unit::kMm}, {"u", Unit::kMm}});
  const double sigma = fitted.placement.Pure().sigma();
  const size_t count = std::min(kMostInSweep, order.size());
  for (size_t row = 0; row < count; ++row) {
    Mean time, angle, residual;
    for (size_t k = row * order.size() / count; k < (row + 1) * order.size() / count; ++k) {
      const Profile& profile = profiles[order[k]];
      time.Add(profile.time, 1);
      angle.Add(profile.alpha, 1);
      residual.Add(means[order[k]]);
    }
    table.rows.push_back({time.Value(), angle.Value(), residual.Value(), sigma / std::sqrt(residual.count)});
  }
  return table;
}

NumberTable CorrelationTable(const std::vector<Profile>& profiles, const std::vector<Mean>& means) {
  std::vector<double> r;
  for (const Group& angle : InGroups(profiles, profiles.size()))
    for (const size_t k : angle.profiles) r.push_back(means[k].Value());
  NumberTable table = TableOf({{"lag", Unit::kOne}, {"correlation", Unit::kOne}});
  const double squares = std::inner_product(r.begin(), r.end(), r.begin(), 0.0);
  for (size_t lag = 0; lag <= std::min(kMostLagsDrawn, r.size() / 4); ++lag) {
    const auto later = r.begin() + static_cast<std::ptrdiff_t>(lag);
    table.rows.push_back({static_cast<double>(lag), std::inner_product(later, r.end(), r.begin(), 0.0) / squares});
  }
  return table;
}

constexpr size_t kMostViews = 9;

// Evenly over the sweep, the first and the last one among them.
std::vector<const Profile*> SomeOf(const std::vector<Profile>& profiles) {
  std::vector<const Profile*> sorted, some;
  for (const Profile& profile : profiles) sorted.push_back(&profile);
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto* a, const auto* b) { return a->alpha < b->alpha; });
  const size_t count = std::min(kMostViews, sorted.size());
  for (size_t k = 0; k < count; ++k) some.push_back(sorted[count > 1 ? k * (sorted.size() - 1) / (count - 1) : 0]);
  return some;
}

}  // namespace

NumberTables ResidualTables(const FittedPlacement& fitted) {
  const std::vector<Profile>& profiles = fitted.placement.profiles;
  if (profiles.empty()) return {};
  const std::vector<std::vector<Piece>> pieces = PiecesOf(fitted);
  std::vector<Mean> means;
  for (const std::vector<Piece>& of_profile : pieces) {
    Mean& mean = means.emplace_back();
    for (const Piece& piece : of_profile) mean.Add(piece.residual);
  }
  NumberTables tables = {{"cells", CellTable(fitted, pieces)},
                         {"sweep", SweepTable(fitted, means)},
                         {"sweep_correlation", CorrelationTable(profiles, means)}};
  if (NumberTable in_time = TimeTable(fitted, means); !in_time.rows.empty()) tables["time"] = std::move(in_time);
  return tables;
}

ViewResiduals ResidualsOf(const Placement& placement) {
  const LineCorrelation along = Correlate(placement.lag_sums);
  const ResidualHistogram& histogram = placement.histogram;
  return {along.lags,
          along.correlation,
          along.length,
          along.dies_out,
          histogram.scale,
          ResidualHistogram::kLimit,
          {histogram.counts.begin(), histogram.counts.end()},
          histogram.below,
          histogram.above};
}

void AddScene(const std::vector<Placement>& placements, Calibration* calibration) {
  const Result<System> system = SystemOf(*calibration);
  CHECK(system.ok()) << system.error().message;
  for (size_t t = 0; t < placements.size(); ++t) {
    TargetSummary& target = calibration->targets[t];
    const Eigen::Vector3d normal = Eigen::Vector3d::Map(target.geometry["normal"].data());
    const double distance = target.geometry["distance"][0];
    NumberTable outline = PointTable(), views = SightTable();
    const auto add_corner = [&](const Profile& profile, const PseudoPoint& end) {
      const Eigen::Vector3d p = system->Point(profile.alpha, end.y, end.z);
      AddPoint(p - (normal.dot(p) - distance) * normal, &outline);
    };
    const std::vector<const Profile*> some = SomeOf(placements[t].profiles);
    for (auto profile = some.begin(); profile != some.end(); ++profile)
      add_corner(**profile, Ends((*profile)->factor)[0]);
    for (auto profile = some.rbegin(); profile != some.rend(); ++profile)
      add_corner(**profile, Ends((*profile)->factor)[1]);
    if (!outline.rows.empty()) outline.rows.push_back(outline.rows.front());
    for (const Profile* profile : some) {
      const ProfileFactor& f = profile->factor;
      AddSight(system->Point(profile->alpha, 0, 0), system->Point(profile->alpha, f(0, 2) / f(0, 0), f(0, 1) / f(0, 0)),
               &views);
    }
    target.scene = {{"outline", outline}, {"views", views}};
  }
}

}  // namespace scancal::turntable
