#include "models/turntable/planes_file.h"
#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include "io/input_file.h"
#include "io/json_file.h"
#include "io/message.h"
#include "io/units.h"
#include "io/yaml.h"
#include "models/scanner.h"

namespace scancal::turntable {
namespace {

using Runs = std::vector<std::array<int64_t, 2>>;

struct NamedPlane {
  std::string name;
  std::shared_ptr<PlaneChoice> choice;
};

std::string InQuotes(const std::string& text) { return Json(text).dump(); }  // YAML takes JSON's strings

// "12-40 44-44", as written; numbers ascend. Empty where it is nothing of the kind.
Runs RunsFrom(const std::string& text) {
  Runs runs;
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto blank = [](char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; };
  for (;;) {
    while (at < end && blank(*at)) ++at;
    if (at == end) return runs;
    std::array<int64_t, 2> run{};
    const auto first = std::from_chars(at, end, run[0]);
    if (first.ec != std::errc() || first.ptr == end || *first.ptr != '-') return {};
    const auto last = std::from_chars(first.ptr + 1, end, run[1]);
    if (last.ec != std::errc() || (last.ptr != end && !blank(*last.ptr))) return {};
    if (run[0] < 1 || run[1] < run[0] || (!runs.empty() && run[0] <= runs.back()[1])) return {};
    runs.push_back(run);
    at = last.ptr;
  }
}

int64_t PointsIn(const Runs& runs) {
  int64_t sum = 0;
  for (const auto& [first, last] : runs) sum += last - first + 1;
  return sum;
}

int64_t Whole(YamlMap map, const char* key) {
  constexpr double kMost = 1e15;
  const double number = map.Number(key);
  if (number >= 1 && number <= kMost && number == std::floor(number)) return static_cast<int64_t>(number);
  map.Fail(key, "expected a number of points");
  return 1;
}

NamedPlane ReadPlane(YamlMap plane, const PlaneChoice& of_scan, const std::string& target, const std::string& file) {
  NamedPlane read{plane.Text("name"), std::make_shared<PlaneChoice>(of_scan)};
  read.choice->place = file + ": target " + target + ": " + read.name;
  if (read.name.empty()) plane.Fail("name", "expected a name");
  const int64_t points = Whole(plane, "points");
  Runs& runs = read.choice->runs;
  runs = RunsFrom(plane.Text("runs"));
  if (runs.empty()) plane.Fail("runs", "expected numbers of points, ascending: 12-40 44-44");
  else if (runs.back()[1] > of_scan.points_in_file)
    plane.Fail("runs", fmt::format("there is a point {}, expected at most {}, the points of the scan", runs.back()[1],
                                   of_scan.points_in_file));
  else if (PointsIn(runs) != points)
    plane.Fail("points", fmt::format("expected {}, as many as its runs hold; was the file cut?", PointsIn(runs)));
  return read;
}

// Of two planes the first point that both hold.
std::optional<int64_t> Shared(const Runs& a, const Runs& b) {
  for (size_t i = 0, k = 0; i < a.size() && k < b.size(); (a[i][1] < b[k][1] ? i : k)++)
    if (a[i][0] <= b[k][1] && b[k][0] <= a[i][1]) return std::max(a[i][0], b[k][0]);
  return {};
}

using PlanesOfTargets = std::map<std::string, std::vector<NamedPlane>>;

Result<PlanesOfTargets> ReadPlanes(const std::filesystem::path& path) {
  SCANCAL_ASSIGN_OR_RETURN(const std::string text, ReadText(path));
  SCANCAL_ASSIGN_OR_RETURN(YamlMap top, YamlMap::Parse(text, path.string()));
  if (top.Number("scancal") != 1) top.Fail("scancal", "expected 1, the version of the format");
  PlanesOfTargets targets;
  for (YamlMap scan : top.Maps("scans")) {
    const std::string target = scan.Text("target");
    if (targets.contains(target)) scan.Fail("target", "expected every target once");
    PlaneChoice of_scan;
    of_scan.points_in_file = Whole(scan, "points");
    of_scan.checksum = scan.Text("checksum");
    std::vector<NamedPlane>& planes = targets[target];
    for (YamlMap plane : scan.Maps("planes")) {
      planes.push_back(ReadPlane(plane, of_scan, target, path.string()));
      for (size_t k = 0; k + 1 < planes.size(); ++k) {
        if (planes[k].name == planes.back().name)
          plane.Fail("name", "expected a name that no other plane of the target has");
        if (const auto both = Shared(planes[k].choice->runs, planes.back().choice->runs))
          plane.Fail("name",
                     fmt::format("point {} is one of {}, too; expected every point once", *both, planes[k].name));
      }
    }
    if (planes.empty()) scan.Fail("planes", "expected at least one plane");
  }
  SCANCAL_RETURN_IF_ERROR(top.Finish());
  return targets;
}

}  // namespace

std::string PlanesToYaml(const std::vector<RangeImage>& images, const FoundPlanes& found) {
  std::string text =
      "# Planes that scancal planes found. Take out those that are none, or that move; names are yours.\n"
      "# runs: the points of the plane, counted as they stand in the scan, missing ones left out.\n"
      "scancal: 1\nscans:\n";
  for (size_t s = 0; s < images.size(); ++s) {
    const RangeImage& image = images[s];
    if (found.scans[s].planes.empty()) continue;
    text += fmt::format("  - target: {}\n    points: {}\n    checksum: \"{}\"\n    planes:\n", InQuotes(image.name),
                        image.points_in_file, image.checksum);
    for (const FoundPlane& plane : found.scans[s].planes) {
      text += fmt::format(
          "      - name: {}\n        points: {}\n        # {} profiles, {:.4g} to {:.4g} deg, rms {:.3g} mm "
          "along depth, {:.0f} deg from the line of sight\n        runs: |",
          InQuotes(NameOf(image, plane)), plane.points.size(), plane.profiles, plane.alpha[0] / kDegree,
          plane.alpha[1] / kDegree, plane.rms, 90 - plane.incidence / kDegree);
      int32_t row = -1;
      for (size_t k = 0, end = 0; k < plane.points.size(); k = end) {
        const auto at = [&](size_t i) { return static_cast<size_t>(plane.points[i]); };
        while (end < plane.points.size() && image.row[at(end)] == image.row[at(k)] &&
               image.number[at(end)] == image.number[at(k)] + static_cast<int64_t>(end - k))
          ++end;
        text += (image.row[at(k)] != row ? "\n          " : " ") +
                fmt::format("{}-{}", image.number[at(k)], image.number[at(end - 1)]);
        row = image.row[at(k)];
      }
      text += "\n";
    }
  }
  return text;
}

Result<void> ChoosePlanes(Declaration* declaration) {
  const std::filesystem::path folder = declaration->dataset.file.parent_path();
  std::map<std::string, PlanesOfTargets> files;
  std::vector<ScanDeclaration> scans;
  std::set<std::string> names;
  for (const ScanDeclaration& scan : declaration->scans) {
    if (scan.planes == "find")
      return Error{scan.planes_place +
                   ": found find, expected the file of planes that you have looked at: scancal "
                   "planes " +
                   folder.string() + " --out=FOLDER proposes them, then planes: FOLDER/planes.yaml takes them"};
    if (scan.planes.empty()) {
      scans.push_back(scan);
    } else {
      if (scan.scan == "-" || std::filesystem::is_fifo(scan.format.path))
        return Error{scan.planes_place + ": " + scan.scan + " can be read once only, expected a file"};
      if (!files.contains(scan.planes)) {
        SCANCAL_ASSIGN_OR_RETURN(files[scan.planes], ReadPlanes(folder / scan.planes));
      }
      const auto found = files[scan.planes].find(scan.name);
      if (found == files[scan.planes].end()) {
        std::vector<std::string> known;
        for (const auto& [target, planes] : files[scan.planes]) known.push_back(target);
        return Error{scan.planes_place + ": " + scan.planes + " has no planes of target " + scan.name +
                     ", it has those of: " + Listed(known)};
      }
      for (const NamedPlane& plane : found->second) {
        scans.push_back(scan);
        scans.back().name += " " + plane.name;
        scans.back().plane = plane.choice;
      }
    }
  }
  for (const ScanDeclaration& scan : scans)
    if (!names.insert(scan.name).second)
      return InFile(declaration->dataset, "targets: two are called " + scan.name + "; expected a name for each");
  declaration->scans = std::move(scans);
  return {};
}

Result<void> CheckSameScan(const ScanDeclaration& scan, const PointsChecksum& checksum) {
  const PlaneChoice& plane = *scan.plane;
  if (checksum.points() == plane.points_in_file && checksum.Text() == plane.checksum) return {};
  return Error{
      fmt::format("{}: found in a scan of {} points with checksum {}, but {} has {} with {}: another scan, or "
                  "one that is read in another way now (units, invalid, where, lines); run scancal planes again",
                  plane.place, plane.points_in_file, plane.checksum, scan.format.path.string(), checksum.points(),
                  checksum.Text())};
}

}  // namespace scancal::turntable
