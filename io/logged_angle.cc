// Angles as a controller logs them: counts of an encoder, a time at constant speed, or none but a constant step.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include "io/message.h"
#include "io/scan.h"

namespace scancal {
namespace {

class LoggedAngleReader : public ScanReader {
 public:
  LoggedAngleReader(LoggedAngle angle, std::unique_ptr<ScanReader> file)
      : angle_(std::move(angle)), file_(std::move(file)) {}
  int64_t bytes_read() const override { return file_->bytes_read(); }
  int64_t bytes_total() const override { return file_->bytes_total(); }
  bool gives_heights() const override { return file_->gives_heights(); }
  std::string Describe() const override {
    const std::string text = file_->Describe();
    return text + (text.empty() ? "" : ", ") + angle_.echo;
  }

  // Of the file of angles: sorted by the column that joins them.
  Result<void> ReadLog(const ScanFormat& format) {
    ScanFormat file;
    file.path = angle_.file;
    file.units = format.units;
    file.text = format.text;
    file.text.where.clear();
    const bool counts = angle_.rad_per_count != 1;
    file.columns = {{angle_.by, Dimension::kNone}, {angle_.column, counts ? Dimension::kNone : Dimension::kAngle}};
    SCANCAL_ASSIGN_OR_RETURN(const std::unique_ptr<ScanReader> reader, ScanReader::Open(file));
    for (ScanBatch batch;;) {
      SCANCAL_ASSIGN_OR_RETURN(const bool more, reader->Next(&batch));
      if (!more) break;
      for (size_t i = 0; i < batch.size(); ++i) log_.emplace_back(batch.columns[0][i], batch.columns[1][i]);
    }
    std::sort(log_.begin(), log_.end());
    for (size_t i = 1; i < log_.size(); ++i)
      if (log_[i].first == log_[i - 1].first && log_[i].second != log_[i - 1].second)
        return Error{angle_.file.string() + ": " + angle_.by + ": found " + Plainly(log_[i].first) +
                     " twice with different angles, expected it once"};
    for (auto& [by, count] : log_) count = Unwound(count);
    return {};
  }

  // Between its neighbours in the log.
  Result<double> Logged(double by) const {
    const auto above =
        std::lower_bound(log_.begin(), log_.end(), std::pair(by, -std::numeric_limits<double>::infinity()));
    if (above == log_.end() || (above == log_.begin() && above->first != by))
      return Error{angle_.file.string() + ": " + angle_.by + ": found no angle at " + Plainly(by) + ", but from " +
                   Plainly(log_.front().first) + " to " + Plainly(log_.back().first)};
    if (above->first == by) return above->second;
    const auto& [x0, y0] = *(above - 1);
    return y0 + (by - x0) / (above->first - x0) * (above->second - y0);
  }

  Result<bool> Next(ScanBatch* batch) override {
    SCANCAL_ASSIGN_OR_RETURN(const bool more, file_->Next(batch));
    missing_ = file_->missing();
    if (angle_.is_step) return more && (CountProfiles(batch), true);
    if (const int column = batch->Find("angle"); more && column >= 0)
      for (double& count : batch->columns[static_cast<size_t>(column)]) {
        if (angle_.file.empty()) {
          count = Unwound(count);
        } else {
          SCANCAL_ASSIGN_OR_RETURN(count, Logged(count));
        }
        count = (count - angle_.zero) * angle_.rad_per_count;
      }
    return more;
  }

 private:
  // A counter that starts again leaps by most of its range.
  double Unwound(double count) {
    if (angle_.wrap > 0) {
      const double leap = count + turns_ * angle_.wrap - last_;
      if (any_ && std::abs(leap) > angle_.wrap / 2) turns_ -= std::round(leap / angle_.wrap);
      count += turns_ * angle_.wrap;
    }
    last_ = count;
    any_ = true;
    return count;
  }

  void CountProfiles(ScanBatch* batch) {
    const std::vector<double> profiles = batch->columns[static_cast<size_t>(batch->Find("profile"))];
    if (!profiles.empty() && !std::exchange(any_, true))
      last_ = angle_.first.value_or(file_->FirstProfile().value_or(profiles.front()));
    int column = batch->Find("angle");
    if (column < 0) {
      column = static_cast<int>(batch->names.size());
      batch->names.emplace_back("angle");
      batch->columns.emplace_back();
    }
    std::vector<double>& angles = batch->columns[static_cast<size_t>(column)];
    angles = profiles;
    for (double& angle : angles) angle = angle_.start + (angle - last_) * angle_.rad_per_count;
  }

  LoggedAngle angle_;
  std::unique_ptr<ScanReader> file_;
  std::vector<std::pair<double, double>> log_;  // joining value, count or angle
  double last_ = 0, turns_ = 0;                 // of the counter; the first profile
  bool any_ = false;
};

}  // namespace

Result<bool> AnglesByProfile(const ScanFormat& format) {
  const auto angle = format.names.find("angle");
  const bool by_profile = angle != format.names.end() && angle->second == "profile";
  if (by_profile || format.wants_angles_from_steps) return by_profile;
  return Error{format.path.string() + ": layout: a file with a profile a " +
               (format.layout && format.layout->tall ? "column" : "row") +
               " has no angles; add angle: {start: ..., step: ...}, or {file: ..., by: profile, column: ...}"};
}

LoggedAngle ReadLoggedAngle(YamlMap map, const std::filesystem::path& folder, const Units& units) {
  LoggedAngle angle;
  const double unit = units.angle_in_rad;
  angle.is_step = map.Has("step");
  if (angle.is_step) {
    angle.start = map.Number("start", 0) * unit;
    angle.rad_per_count = map.Number("step") * unit;
    if (map.Has("first")) angle.first = map.Number("first");
    if (angle.rad_per_count == 0) map.Fail("step", "expected the angle from one profile to the next, not 0");
    angle.echo = "angle " + Plainly(angle.start / unit) + " " + units.angle + " in the first profile, then " +
                 Plainly(angle.rad_per_count / unit) + " more a profile";
    return angle;
  }
  angle.column = map.Text("column", "angle");
  angle.zero = map.Number("zero", 0);
  angle.wrap = map.Number("wrap", 0);
  if (angle.wrap < 0) map.Fail("wrap", "expected how many counts the counter has before it starts again");
  if (map.Has("file")) {
    const std::string name = map.Text("file");
    angle.file = folder / name;
    angle.by = map.Text("by");
    angle.echo = " in " + name + " by " + angle.by;
  }
  if (!angle.file.empty() && !map.Has("counts_per_turn")) {  // it has angles
    angle.zero *= unit;
    angle.wrap *= unit;
    angle.echo = "angle from " + angle.column + angle.echo;
    return angle;
  }
  if (map.Has("counts_per_turn") == map.Has("speed"))
    map.Fail("", "expected counts_per_turn, speed, file and by, or start and step");
  const char* const key = map.Has("speed") ? "speed" : "counts_per_turn";
  const double number = map.Number(key, 1);
  if (number == 0) map.Fail(key, "expected a number that is not 0");
  angle.rad_per_count = map.Has("speed") ? number * unit : 2 * std::numbers::pi / number;
  angle.echo = "angle from " + angle.column + angle.echo + ", " + Plainly(number) +
               (map.Has("speed") ? " " + units.angle + " a unit of it" : " counts a turn");
  if (angle.zero != 0) angle.echo += ", zero at " + Plainly(angle.zero);
  if (angle.wrap != 0) angle.echo += ", starting again after " + Plainly(angle.wrap);
  return angle;
}

Result<std::unique_ptr<ScanReader>> OpenLogged(const ScanFormat& format) {
  ScanFormat file = format;
  const LoggedAngle angle = *std::exchange(file.angle, std::nullopt);
  for (ScanColumn& column : file.columns) {
    if (column.name == "angle") column.dimension = Dimension::kNone;
    if (angle.is_step && column.name == "angle") column.required = false;
    if (angle.is_step && column.name == "profile") {
      column.required = true;
      column.remedy = "; it counts the profiles, from which angle: step makes angles";
    }
  }
  if (!angle.is_step) {
    file.names["angle"] = angle.file.empty() ? angle.column : angle.by;
  } else {
    std::erase_if(file.columns, [](const ScanColumn& column) { return column.name == "angle"; });
    file.wants_angles_from_steps = true;
    if (file.layout && !file.layout->tall) file.layout->angle_column = 0;
  }
  SCANCAL_ASSIGN_OR_RETURN(std::unique_ptr<ScanReader> reader, ScanReader::Open(file));
  auto logged = std::make_unique<LoggedAngleReader>(angle, std::move(reader));
  if (!angle.file.empty()) SCANCAL_RETURN_IF_ERROR(logged->ReadLog(format));
  return std::unique_ptr<ScanReader>(std::move(logged));
}

}  // namespace scancal
