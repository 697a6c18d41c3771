#include "models/turntable/scene.h"
#include <glog/logging.h>
#include <algorithm>
#include <cmath>
#include "models/tables.h"
#include "models/turntable/calibrated_turntable.h"

namespace scancal {
namespace {

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

void AddScene(const std::vector<Placement>& placements, Calibration* calibration) {
  const Result<CalibratedTurntable> turntable = CalibratedTurntable::From(*calibration);
  CHECK(turntable.ok()) << turntable.error().message;
  for (size_t t = 0; t < placements.size(); ++t) {
    TargetSummary& target = calibration->targets[t];
    const Eigen::Vector3d normal = Eigen::Vector3d::Map(target.geometry["normal"].data());
    const double distance = target.geometry["distance"][0];
    NumberTable outline = PointTable(), views = SightTable();
    const auto add_corner = [&](const Profile& profile, const PseudoPoint& end) {
      const Eigen::Vector3d p = turntable->Point(profile.alpha, end.y, end.z);
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
      AddSight(turntable->Point(profile->alpha, 0, 0),
               turntable->Point(profile->alpha, f(0, 2) / f(0, 0), f(0, 1) / f(0, 0)), &views);
    }
    target.scene = {{"outline", outline}, {"views", views}};
  }
}

}  // namespace scancal
