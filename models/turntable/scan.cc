#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <span>
#include "io/message.h"
#include "models/line/moments.h"
#include "models/turntable/compress.h"
#include "models/turntable/planes_file.h"
#include "models/turntable/range_image.h"
#include "models/turntable/verify.h"

namespace scancal::turntable {
namespace {

constexpr Message<std::string_view> kLooksShuffled{
    "turntable.looks_shuffled",
    "target {}: most profiles hold one point and their angles recur; if the points are not in the order of the "
    "profiles, add a column profile, or u is too small",
    "Prüfkörper {}: Die meisten Profile haben nur einen Punkt, und ihre Winkel kehren wieder; stehen die Punkte nicht "
    "in der Reihenfolge der Profile, so ist eine Spalte profile zu ergänzen, sonst ist u zu klein"};

// Takes from `kept` what is no part of the plane. before: points of the file that came before this batch.
void KeepPlane(const PlaneChoice& plane, int64_t before, size_t* run, std::vector<char>* kept) {
  for (size_t i = 0; i < kept->size(); ++i) {
    const int64_t number = before + static_cast<int64_t>(i) + 1;
    while (*run < plane.runs.size() && plane.runs[*run][1] < number) ++*run;
    (*kept)[i] &= static_cast<char>(*run < plane.runs.size() && plane.runs[*run][0] <= number);
  }
}

constexpr size_t kTakenPoints = 100'000;  // at once, from a scan whose points are not held

// Groups points into profiles as they come.
class Gatherer {
 public:
  explicit Gatherer(const std::filesystem::path& path) : path_(path) {}

  // Points of one profile. key, time: if the file has them.
  Result<void> Add(double alpha, const double* key, const double* time, double temperature, std::span<const double> y,
                   std::span<const double> z, std::span<const double> range) {
    const size_t before = begun_;
    RawProfile* profile = key ? ByKey(*key, alpha) : ByAngle(alpha);
    if (begun_ > before) {
      profile->time = time ? *time : static_cast<double>(before);
      profile->temperature = temperature;
    }
    by_key_ = key != nullptr;
    if (profile->alpha != alpha) {
      return Error{fmt::format("{}: profile {:g}: found angles {:.9g} and {:.9g} rad, expected one angle a profile",
                               path_.string(), *key, profile->alpha, alpha)};
    }
    profile->y.insert(profile->y.end(), y.begin(), y.end());
    profile->z.insert(profile->z.end(), z.begin(), z.end());
    profile->range.insert(profile->range.end(), range.begin(), range.end());
    points_ += y.size();
    held_ += y.size();
    return {};
  }

  bool by_key() const { return by_key_; }
  size_t points() const { return points_; }
  size_t held() const { return held_; }  // of them, not taken yet
  bool ranged() const { return !profiles_.empty() && !profiles_.front().range.empty(); }
  // All but the last, which may go on.
  std::vector<RawProfile> TakeComplete() {
    RawProfile last = std::move(profiles_.back());
    profiles_.pop_back();
    std::vector<RawProfile> complete = std::move(profiles_);
    profiles_.clear();
    held_ = last.y.size();
    profiles_.push_back(std::move(last));
    return complete;
  }

  std::vector<RawProfile> Take() {
    std::stable_sort(profiles_.begin(), profiles_.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
    return std::move(profiles_);
  }

 private:
  RawProfile* ByAngle(double alpha) {
    if (profiles_.empty() || profiles_.back().alpha != alpha) {
      const size_t like_the_last = profiles_.empty() ? 0 : profiles_.back().y.size();
      profiles_.push_back({static_cast<double>(begun_++), alpha, {}, {}, {}, 0, 0});
      profiles_.back().y.reserve(like_the_last);
      profiles_.back().z.reserve(like_the_last);
    }
    return &profiles_.back();
  }
  RawProfile* ByKey(double key, double alpha) {
    if (!profiles_.empty() && profiles_[last_].key == key) return &profiles_[last_];
    const auto [found, fresh] = index_.try_emplace(key, profiles_.size());
    if (fresh) profiles_.push_back({key, alpha, {}, {}, {}, 0, 0});
    begun_ += fresh;
    last_ = found->second;
    return &profiles_[last_];
  }

  std::filesystem::path path_;
  std::vector<RawProfile> profiles_;
  std::map<double, size_t> index_;
  size_t last_ = 0;
  bool by_key_ = false;
  size_t points_ = 0, held_ = 0, begun_ = 0;
};

bool LooksShuffled(const std::vector<Profile>& profiles) {
  double points = 0;
  std::set<double> angles;
  for (const Profile& profile : profiles) {
    points += profile.count;
    angles.insert(profile.alpha);
  }
  return points < 2 * static_cast<double>(profiles.size()) && 3 * angles.size() < profiles.size();
}

}  // namespace

void OrderAlongLine(RawProfile* profile) {
  const std::vector<double>& z = profile->z;
  if (IsAscending(z.data(), z.size())) return;
  std::vector<size_t> order(z.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return z[a] < z[b]; });
  const RawProfile from = *profile;
  for (const auto column : {&RawProfile::y, &RawProfile::z, &RawProfile::range})
    for (size_t i = 0; i < (from.*column).size(); ++i) (profile->*column)[i] = (from.*column)[order[i]];
}

void ToSensor(const Senses& senses, const ScanBatch& batch, SensorColumns* points) {
  points->alpha = batch.columns[batch.Find("angle")];
  for (double& alpha : points->alpha) alpha *= senses.angle;
  const int y = batch.Find("y"), z = batch.Find("z"), bearing = batch.Find("bearing"), range = batch.Find("range");
  if (bearing >= 0 && range >= 0) {
    points->range = batch.columns[range];
    points->y.resize(batch.size());
    points->z.resize(batch.size());
    for (size_t i = 0; i < batch.size(); ++i) {
      points->y[i] = points->range[i] * std::cos(batch.columns[bearing][i]);
      points->z[i] = points->range[i] * std::sin(batch.columns[bearing][i]);
    }
  } else {  // the reader has made sure of them
    points->y = batch.columns[y];
    points->z = batch.columns[z];
    for (size_t i = 0; i < batch.size() && senses.depth < 0; ++i) points->y[i] = -points->y[i];
  }
}

Result<std::vector<char>> Kept(const ScanDeclaration& scan, const ScanBatch& batch, const SensorColumns& points) {
  std::vector<char> kept(batch.size(), 1);
  for (const KeepInterval& interval : scan.keep) {
    const int found = batch.Find(interval.column);
    const std::vector<double>* values = found >= 0               ? &batch.columns[found]
                                        : interval.column == "y" ? &points.y
                                        : interval.column == "z" ? &points.z
                                                                 : nullptr;
    if (!values)
      return Error{scan.format.path.string() + ": keep: " + interval.column + ": no such column, found " +
                   Listed(batch.names)};
    for (size_t i = 0; i < kept.size(); ++i)
      kept[i] &= (*values)[i] >= interval.lower && (*values)[i] <= interval.upper;
  }
  return kept;
}

Error HeightsWithoutSense(const ScanDeclaration& scan) {
  return {
      fmt::format("{}: target {}: its maker counts y towards the sensor, expected depth: towards in the data "
                  "set, or depth: away if it was turned round since",
                  scan.format.path.string(), scan.name)};
}

namespace {

// The profiles that were gathered, to the points that are kept of them.
Result<void> TakeIn(std::vector<RawProfile> profiles, const ScanDeclaration& declaration, const Gatherer& gatherer,
                    double depth, RawScan* scan) {
  const bool first = scan->compressed.empty();
  scan->profiles = std::move(profiles);
  if (scan->profiles.empty()) return {};
  if (first)
    if (const std::optional<double> value = RepeatedValue(scan->profiles))
      return Error{
          fmt::format("{}: target {}: {} = {:.9g} stands in most profiles, apart from all other values: where a sensor "
                      "sees nothing it "
                      "writes such a number; declare invalid: {:.9g}, or if it was measured, leave those points out",
                      declaration.format.path.string(), declaration.name, gatherer.ranged() ? "range" : "y",
                      *value * depth / declaration.format.units.length_in_mm,
                      *value * depth / declaration.format.units.length_in_mm)};
  if (!gatherer.by_key()) SplitAtRoundedAngles(scan);
  scan->lines += static_cast<double>(scan->profiles.size());
  Clean(scan);
  return {};
}

Result<std::unique_ptr<ScanReader>> OpenScan(const ScanDeclaration& scan, const Senses& senses) {
  SCANCAL_ASSIGN_OR_RETURN(std::unique_ptr<ScanReader> reader, ScanReader::Open(scan.format));
  if (reader->gives_heights() && !senses.depth_declared) return HeightsWithoutSense(scan);
  return reader;
}

// What is kept of a scan, batch by batch; at its end the planes of another scan are refused.
class KeptBatches {
 public:
  KeptBatches(const ScanDeclaration& scan, const Senses& senses, ScanReader* reader)
      : scan_(scan), senses_(senses), reader_(reader) {}
  Result<bool> Next() {
    SCANCAL_ASSIGN_OR_RETURN(const bool more, reader_->Next(&batch));
    if (!more) {
      if (scan_.plane) SCANCAL_RETURN_IF_ERROR(CheckSameScan(scan_, checksum_));
      return false;
    }
    ToSensor(senses_, batch, &points);
    SCANCAL_ASSIGN_OR_RETURN(kept, Kept(scan_, batch, points));
    if (scan_.plane) {
      KeepPlane(*scan_.plane, checksum_.points(), &run_, &kept);
      checksum_.Add(batch);
    }
    return true;
  }

  ScanBatch batch;
  SensorColumns points;
  std::vector<char> kept;  // of each point whether

 private:
  const ScanDeclaration& scan_;
  const Senses& senses_;
  ScanReader* reader_;
  PointsChecksum checksum_;
  size_t run_ = 0;
};

}  // namespace

Result<SensorColumns> ReadKept(const ScanDeclaration& scan, const Senses& senses) {
  SCANCAL_ASSIGN_OR_RETURN(const auto reader, OpenScan(scan, senses));
  KeptBatches batches(scan, senses, reader.get());
  SensorColumns all;
  for (;;) {
    SCANCAL_ASSIGN_OR_RETURN(const bool more, batches.Next());
    if (!more) return all;
    for (const auto column : {&SensorColumns::alpha, &SensorColumns::y, &SensorColumns::z, &SensorColumns::range})
      for (size_t i = 0; i < (batches.points.*column).size(); ++i)
        if (batches.kept[i]) (all.*column).push_back((batches.points.*column)[i]);
  }
}

Result<RawScan> ReadScan(const ScanDeclaration& scan, const Senses& senses,
                         const std::function<void(double)>& progress) {
  SCANCAL_ASSIGN_OR_RETURN(const auto reader, OpenScan(scan, senses));
  Gatherer gatherer(scan.format.path);
  KeptBatches batches(scan, senses, reader.get());
  const ScanBatch& batch = batches.batch;
  const SensorColumns& points = batches.points;
  const std::vector<char>& kept = batches.kept;
  RawScan result;
  result.name = scan.name;
  for (;;) {
    SCANCAL_ASSIGN_OR_RETURN(const bool more, batches.Next());
    if (!more) break;
    const int profile = batch.Find("profile"), time = batch.Find("time"), temperature = batch.Find("temperature");
    result.timed |= time >= 0;
    const double* const keys = profile >= 0 ? batch.columns[profile].data() : nullptr;
    for (size_t i = 0, end = 0; i < batch.size(); i = end) {
      const auto goes_on = [&](size_t k) {
        return kept[k] && points.alpha[k] == points.alpha[i] && (!keys || keys[k] == keys[i]);
      };
      end = i + 1;
      if (!kept[i]) continue;
      while (end < batch.size() && goes_on(end)) ++end;
      const auto of = [&](const std::vector<double>& column) {
        return column.empty() ? std::span<const double>() : std::span(column).subspan(i, end - i);
      };
      SCANCAL_RETURN_IF_ERROR(gatherer.Add(
          points.alpha[i], keys ? &keys[i] : nullptr, time >= 0 ? &batch.columns[time][i] : nullptr,
          temperature >= 0 ? batch.columns[temperature][i] : 0, of(points.y), of(points.z), of(points.range)));
    }
    if (gatherer.points() > kHeldPoints && gatherer.held() >= kTakenPoints && !gatherer.by_key() &&
        !gatherer.ranged()) {
      result.holds_points = false;
      SCANCAL_RETURN_IF_ERROR(TakeIn(gatherer.TakeComplete(), scan, gatherer, senses.depth, &result));
    }
    progress(static_cast<double>(reader->bytes_read()) /
             static_cast<double>(std::max<int64_t>(1, reader->bytes_total())));
  }
  if (gatherer.points() == 0)
    return Error{scan.format.path.string() + ": target " + scan.name + ": no point is left; widen its keep: intervals"};
  result.missing = static_cast<double>(reader->missing());
  result.dialect = reader->Describe();
  SCANCAL_RETURN_IF_ERROR(TakeIn(gatherer.Take(), scan, gatherer, senses.depth, &result));
  NoteRoundedAngles(&result);
  if (!gatherer.by_key() && LooksShuffled(result.compressed)) result.warnings.push_back(Say(kLooksShuffled, scan.name));
  return result;
}

}  // namespace scancal::turntable
