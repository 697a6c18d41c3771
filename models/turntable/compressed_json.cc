// Compressed placements as JSON and back.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include "io/input_file.h"
#include "io/json_file.h"
#include "models/scanner.h"
#include "models/turntable/compress.h"

namespace scancal::turntable {
namespace {

constexpr char kLayout[] =
    "segments: base64 of little-endian float64. For each target first the residuals of its points from the line of "
    "their own profile: the number of lags, then three numbers for each lag (0, 1, 2, 3, 4, 6, 8, 12, 16, ... points): "
    "the sum of products, how many, the sum that the lines absorb; then their standard deviation in mm, and the counts "
    "of residuals divided by it: below -8, above 8, in 81 bins between. Then for each profile: alpha in rad, the "
    "number of its points, the number of its segments along z, for each segment r00 r01 r02 r11 r12 r22 of the upper "
    "triangle R (mm) for which R'R = F'F, F the rows (1, z, y) of its points; of a lidar r00 ... r22 once more, of all "
    "rows (1, z, y) times the range at the profile's line";
constexpr size_t kMostLagsStored = 100;

class Writer {
 public:
  void Add(double number) {
    const auto bits = std::bit_cast<uint64_t>(number);
    for (unsigned byte = 0; byte < 8; ++byte) bytes_ += static_cast<char>(bits >> 8 * byte & 255U);
  }
  void Add(const ProfileFactor& r) {
    for (const double number : {r(0, 0), r(0, 1), r(0, 2), r(1, 1), r(1, 2), r(2, 2)}) Add(number);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

// Numbers one by one. What is not there or cannot be is zero, and all() is false from then on.
class Reader {
 public:
  explicit Reader(std::string bytes) : bytes_(std::move(bytes)) {}

  double Number() {
    double number = 0;
    if (at_ + 8 <= bytes_.size()) {
      uint64_t bits = 0;
      for (unsigned byte = 0; byte < 8; ++byte)
        bits |= static_cast<uint64_t>(static_cast<unsigned char>(bytes_[at_ + byte])) << 8 * byte;
      at_ += 8;
      number = std::bit_cast<double>(bits);
    } else {
      sound_ = false;
    }
    return Require(std::isfinite(number)) ? number : 0;
  }
  size_t Whole(size_t least, size_t most) {
    const double number = Number();
    const bool fits = number >= static_cast<double>(least) && number <= static_cast<double>(most);
    return Require(fits && std::floor(number) == number) ? static_cast<size_t>(number) : 0;
  }
  ProfileFactor Factor() {
    ProfileFactor r = ProfileFactor::Zero();
    for (const auto& [i, j] : {std::pair{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}) r(i, j) = Number();
    if (!Require(r(0, 0) > 0)) r(0, 0) = 1;
    return r;
  }
  bool Require(bool condition) { return sound_ &= condition; }
  bool sound() const { return sound_; }
  bool AllTaken() const { return sound_ && at_ == bytes_.size(); }

 private:
  std::string bytes_;
  size_t at_ = 0;
  bool sound_ = true;
};

void Write(const Placement& placement, Writer* out) {
  const LagSums& sums = placement.lag_sums;
  out->Add(static_cast<double>(sums.products.size()));
  for (size_t k = 0; k < sums.products.size(); ++k)
    for (const auto* numbers : {&sums.products, &sums.pairs, &sums.absorbed}) out->Add((*numbers)[k]);
  for (const double number : {placement.histogram.scale, placement.histogram.below, placement.histogram.above})
    out->Add(number);
  for (const double count : placement.histogram.counts) out->Add(count);
  for (const Profile& profile : placement.profiles) {
    for (const double number : {profile.alpha, profile.count, static_cast<double>(profile.segments.size())})
      out->Add(number);
    for (const ProfileFactor& segment : profile.segments) out->Add(segment);
    if (profile.ranged) out->Add(*profile.ranged);
  }
}

Profile ReadProfile(bool lidar, Reader* in) {
  const double alpha = in->Number();
  const auto count = static_cast<double>(in->Whole(1, size_t{1} << 52));
  std::vector<ProfileFactor> segments(std::max<size_t>(1, in->Whole(1, kSegments)), ProfileFactor::Identity());
  double points = 0;
  for (ProfileFactor& segment : segments) {
    segment = in->Factor();
    points += segment(0, 0) * segment(0, 0);
  }
  in->Require(std::abs(points - count) <= 1e-6 * count);
  std::optional<ProfileFactor> ranged;
  if (lidar) ranged = in->Factor();
  return MakeProfile(alpha, count, std::move(segments), ranged);
}

void Read(bool lidar, size_t profiles, Reader* in, Placement* placement) {
  LagSums& sums = placement->lag_sums;
  const size_t lags = in->Whole(0, kMostLagsStored);
  for (size_t k = 0; k < lags; ++k)
    for (auto* numbers : {&sums.products, &sums.pairs, &sums.absorbed}) numbers->push_back(in->Number());
  for (double* number : {&placement->histogram.scale, &placement->histogram.below, &placement->histogram.above})
    *number = in->Number();
  for (double& count : placement->histogram.counts) count = in->Number();
  for (size_t k = 0; k < profiles && in->sound(); ++k) placement->profiles.push_back(ReadProfile(lidar, in));
}

bool IsCount(const Json& json) { return json.is_number_integer() && json.get<int64_t>() >= 0; }

// All but what is in segments; nothing if a value is missing or of another kind.
std::optional<Placement> ReadTarget(const Json& json) {
  if (!json.is_object()) return std::nullopt;
  for (const char* key : {"name", "missing", "set_aside", "largest", "lidar", "profiles", "warning"})
    if (!json.contains(key)) return std::nullopt;
  const std::optional<Sentence> warning = SentenceFromJson(json["warning"]);
  if (!json["name"].is_string() || !warning || !json["lidar"].is_boolean() || !json["largest"].is_number() ||
      !IsCount(json["missing"]) || !IsCount(json["profiles"]) || json["profiles"] == 0 ||
      !json["set_aside"].is_object())
    return std::nullopt;
  Placement placement;
  placement.name = json["name"];
  if (!warning->empty()) placement.warnings.push_back(*warning);
  if (json.contains("more_warnings")) {
    for (const Json& more : json["more_warnings"]) {
      const std::optional<Sentence> sentence = SentenceFromJson(more);
      if (!sentence) return std::nullopt;
      placement.warnings.push_back(*sentence);
    }
  }
  placement.missing = json["missing"];
  placement.largest = json["largest"];
  for (const auto& [reason, count] : json["set_aside"].items()) {
    if (!IsCount(count)) return std::nullopt;
    placement.set_aside[reason] = count;
  }
  return placement;
}

}  // namespace

Result<Json> PlacementsToJson(const std::vector<Placement>& placements) {
  Json targets = Json::array();
  Writer numbers;
  for (const Placement& placement : placements) {
    Json set_aside = Json::object();
    for (const auto& [reason, count] : placement.set_aside) set_aside[reason] = static_cast<int64_t>(count);
    targets.push_back({{"name", placement.name},
                       {"missing", static_cast<int64_t>(placement.missing)},
                       {"set_aside", set_aside},
                       {"largest", placement.largest},
                       {"lidar", placement.IsLidar()},
                       {"profiles", placement.profiles.size()},
                       {"warning", ToJson(placement.warnings.empty() ? Sentence{} : placement.warnings.front())}});
    for (size_t k = 1; k < placement.warnings.size(); ++k)
      targets.back()["more_warnings"].push_back(ToJson(placement.warnings[k]));
    const bool warm = std::any_of(placement.profiles.begin(), placement.profiles.end(),
                                  [](const Profile& profile) { return profile.temperature != 0; });
    for (size_t k = 0; k < placement.profiles.size() && warm; ++k)
      targets.back()["temperatures"].push_back(placement.profiles[k].temperature);
    if (placement.timed)
      for (const Profile& profile : placement.profiles) targets.back()["times"].push_back(profile.time);
    Write(placement, &numbers);
  }
  const std::string segments = ToBase64(numbers.bytes());
  SCANCAL_ASSIGN_OR_RETURN(const std::string sha256, Sha256OfText(segments));
  return Json{{"layout", kLayout}, {"targets", targets}, {"sha256", sha256}, {"segments", segments}};
}

Result<std::vector<Placement>> PlacementsFromJson(const Json& data, const std::string& file) {
  const auto damaged = [&](const std::string& what) {
    return Error{file + ": data: " + what + "; the file was changed or damaged, take another copy of it"};
  };
  if (!data.contains("segments") || !data["segments"].is_string()) return damaged("found no segments");
  const auto& text = data["segments"].get_ref<const std::string&>();
  const auto bytes = FromBase64(text);
  if (!bytes.ok()) return damaged("segments: " + bytes.error().message);
  SCANCAL_ASSIGN_OR_RETURN(const std::string sha256, Sha256OfText(text));
  if (!data.contains("sha256") || data["sha256"] != sha256)
    return damaged("segments: found SHA-256 " + sha256 + ", expected that of data: sha256");
  if (!data.contains("targets") || !data["targets"].is_array()) return damaged("found no list of targets");

  std::vector<Placement> placements;
  Reader numbers(*bytes);
  for (const Json& target : data["targets"]) {
    std::optional<Placement> placement = ReadTarget(target);
    if (!placement)
      return damaged("target " + std::to_string(placements.size() + 1) +
                     ": expected name, missing, set_aside, largest, lidar, profiles and warning");
    Read(target["lidar"], target["profiles"], &numbers, &*placement);
    for (size_t k = 0; k < placement->profiles.size(); ++k) placement->profiles[k].time = static_cast<double>(k);
    if (target.contains("times") && numbers.sound()) {
      const Json& times = target["times"];
      placement->timed = times.is_array() && times.size() == placement->profiles.size();
      for (size_t k = 0; k < times.size() && placement->timed; ++k) {
        placement->timed = times[k].is_number();
        if (placement->timed) placement->profiles[k].time = times[k];
      }
      if (!placement->timed)
        return damaged("target " + placement->name + ": times: expected a number for each profile");
    }
    if (target.contains("temperatures") && numbers.sound()) {
      const Json& temperatures = target["temperatures"];
      if (!temperatures.is_array() || temperatures.size() != placement->profiles.size())
        return damaged("target " + placement->name + ": temperatures: expected a number for each profile");
      for (size_t k = 0; k < temperatures.size(); ++k)
        if (temperatures[k].is_number()) placement->profiles[k].temperature = temperatures[k];
    }
    placements.push_back(std::move(*placement));
  }
  if (!numbers.AllTaken()) return damaged("segments: found other numbers than data: layout says");
  return placements;
}

}  // namespace scancal::turntable
