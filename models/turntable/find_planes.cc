#include "models/turntable/find_planes.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include "models/turntable/grow_planes.h"
#include "models/turntable/scanner.h"

namespace scancal::turntable {
namespace {

constexpr size_t kPointsOfMount = 300'000;  // from which M and N are estimated
constexpr double kNodesASide = 60;
constexpr double kAlikeNormals = 0.985;  // cosine: 10 degrees
constexpr double kAlikePlaces = 0.3;     // of the rectangles in (angle, line): intersection over union

// Planes of two sweeps that are one.
bool AreOne(const FoundPlane& a, const FoundPlane& b) {
  if (std::abs(a.normal.dot(b.normal)) < kAlikeNormals) return false;
  double common = 1, all_a = 1, all_b = 1;
  for (const auto side : {&FoundPlane::alpha, &FoundPlane::across}) {
    const std::array<double, 2>&of_a = a.*side, &of_b = b.*side;
    common *= std::max(0.0, std::min(of_a[1], of_b[1]) - std::max(of_a[0], of_b[0]));
    all_a *= of_a[1] - of_a[0];
    all_b *= of_b[1] - of_b[0];
  }
  return common > kAlikePlaces * (all_a + all_b - common);
}

// The largest first; a plane of a later sweep takes the number of the one that it is.
void Number(std::vector<FoundPlane>* planes) {
  std::stable_sort(planes->begin(), planes->end(),
                   [](const auto& a, const auto& b) { return a.points.size() > b.points.size(); });
  int last = 0;
  for (size_t k = 0; k < planes->size(); ++k) {
    FoundPlane& plane = (*planes)[k];
    for (size_t i = 0; i < k && plane.number == 0; ++i) {
      const FoundPlane& other = (*planes)[i];
      const auto is_taken = [&](const FoundPlane& each) {
        return each.number == other.number && each.sweep == plane.sweep;
      };
      if (!std::any_of(planes->begin(), planes->begin() + static_cast<std::ptrdiff_t>(k), is_taken) &&
          AreOne(plane, other))
        plane.number = other.number;
    }
    if (plane.number == 0) plane.number = ++last;
  }
  std::stable_sort(planes->begin(), planes->end(), [](const auto& a, const auto& b) {
    return std::pair(a.number, a.sweep) < std::pair(b.number, b.sweep);
  });
}

FoundPlane Described(const RangeImage& image, size_t sweep, GrownPlane grown) {
  FoundPlane found;
  found.sweep = sweep;
  found.normal = grown.normal;
  found.rms = grown.rms;
  found.incidence = std::acos(std::min(1.0, grown.cosine));
  int32_t left = image.columns, right = 0;
  std::vector<char> seen(image.alpha.size(), 0);
  found.alpha = {image.alpha[static_cast<size_t>(image.row[static_cast<size_t>(grown.points.front())])], 0};
  found.alpha[1] = found.alpha[0];
  for (const int32_t p : grown.points) {
    const auto row = static_cast<size_t>(image.row[static_cast<size_t>(p)]);
    found.profiles += static_cast<int32_t>(!seen[row]);
    seen[row] = 1;
    left = std::min(left, image.column[static_cast<size_t>(p)]);
    right = std::max(right, image.column[static_cast<size_t>(p)]);
    found.alpha = {std::min(found.alpha[0], image.alpha[row]), std::max(found.alpha[1], image.alpha[row])};
  }
  found.across = {image.first_across + left * image.pitch, image.first_across + right * image.pitch};
  found.points = std::move(grown.points);
  return found;
}

PlanesOfScan GrowIn(const RangeImage& image, const System& system, const std::array<double, 2>& slack) {
  PlanesOfScan result;
  for (size_t sweep = 0; sweep < image.sweeps.size(); ++sweep) {
    GrownPlanes grown = GrowPlanes(image, sweep, system, slack);
    result.bent += grown.bent;
    result.edge_on += grown.edge_on;
    for (GrownPlane& each : grown.planes) result.planes.push_back(Described(image, sweep, std::move(each)));
  }
  Number(&result.planes);
  return result;
}

// What the planes tell of the system; nothing where they do not determine M and N within the search.
std::optional<System> SystemFrom(const std::vector<RangeImage>& images, const std::vector<PlanesOfScan>& found,
                                 const Declaration& declaration, const Model& model, GridBox box) {
  size_t points = 0;
  for (const PlanesOfScan& each : found)
    for (const FoundPlane& plane : each.planes) points += plane.points.size();
  std::vector<RawScan> scans;
  for (size_t s = 0; s < images.size(); ++s) {
    for (FoundPlane plane : found[s].planes) {
      const size_t every = points / kPointsOfMount + 1;
      size_t k = 0;
      std::erase_if(plane.points, [&](int32_t) { return k++ % every != 0; });
      scans.push_back(ScanOf(images[s], plane, NameOf(images[s], plane)));
      Clean(&scans.back());
    }
  }
  if (scans.empty()) return {};
  const auto scanner = Compress(declaration, model, scans);
  if (!scanner.ok()) return {};
  box.step = std::max(box.step, std::max(box.upper[0] - box.lower[0], box.upper[1] - box.lower[1]) / kNodesASide);
  const Result<Start> start = (*scanner)->FindStartIn(box);
  if (!start.ok()) return {};
  for (const size_t k : {0, 1}) {
    const double half = (box.upper[k] - box.lower[k]) / 2;
    if (std::abs(start->system[k] - (box.lower[k] + half)) > 1.5 * half + 1e-9) return {};
  }
  return start->system;
}

}  // namespace

FoundPlanes FindPlanes(const std::vector<RangeImage>& images, const Declaration& declaration, const Model& model,
                       const std::function<void(double)>& progress) {
  const GridBox box = Scanner(declaration, model, {}).Box();
  FoundPlanes found;
  for (size_t k = 0; k < found.system.q.size(); ++k) found.system[k] = model.quantities()[k].value;
  std::array<double, 2> slack{};
  for (const size_t k : {0, 1}) {
    found.system[k] = (box.lower[k] + box.upper[k]) / 2;
    slack[k] = (box.upper[k] - box.lower[k]) / 2;
  }
  const bool known = slack[0] == 0 && slack[1] == 0;
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    if (round > 0) {
      const std::optional<System> system = SystemFrom(images, found.scans, declaration, model, box);
      if (!system) break;
      found.system = *system;
      found.refined = true;
      for (double& each : slack) each = round + 1 < kRounds ? each / 10 : 0;
    }
    found.scans.clear();
    for (const RangeImage& image : images) {
      found.scans.push_back(GrowIn(image, found.system, slack));
      progress((round + static_cast<double>(found.scans.size()) / static_cast<double>(images.size())) / kRounds);
    }
    if (known) break;
  }
  return found;
}

RawScan ScanOf(const RangeImage& image, const FoundPlane& plane, const std::string& name) {
  RawScan scan;
  scan.name = name;
  std::map<int32_t, RawProfile> profiles;
  for (const int32_t p : plane.points) {
    const auto at = static_cast<size_t>(p);
    RawProfile& profile = profiles[image.row[at]];
    profile.key = profile.time = image.row[at];
    profile.alpha = image.alpha[static_cast<size_t>(image.row[at])];
    profile.y.push_back(image.y[at]);
    profile.z.push_back(image.z[at]);
    if (image.lidar) profile.range.push_back(std::hypot(image.y[at], image.z[at]));
  }
  for (auto& [row, profile] : profiles) scan.profiles.push_back(std::move(profile));
  scan.lines = static_cast<double>(scan.profiles.size());
  return scan;
}

std::string NameOf(const RangeImage& image, const FoundPlane& plane) {
  std::string name = fmt::format("plane {}", plane.number);
  if (image.sweeps.size() < 2) return name;
  name += image.Rises(plane.sweep) ? " up" : " down";
  int before = 0;
  for (size_t k = 0; k < plane.sweep; ++k) before += static_cast<int>(image.Rises(k) == image.Rises(plane.sweep));
  return before == 0 ? name : fmt::format("{} {}", name, before + 1);
}

}  // namespace scancal::turntable
