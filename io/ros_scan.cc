// Scans from bags: each LaserScan a profile, its angle the position of a joint in the middle of the scan.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>
#include "io/file_kind.h"
#include "io/message.h"
#include "io/ros.h"

namespace scancal {
namespace {

constexpr double kMillimetre_per_m = 1000;
constexpr double kDegrees_per_rad = 180 / std::numbers::pi;

double InSeconds(int64_t nanoseconds) { return 1e-9 * static_cast<double>(nanoseconds); }

// A joint's positions over time.
class JointTrack {
 public:
  void Add(int64_t stamp_ns, double position) { states_.emplace_back(stamp_ns, position); }
  size_t size() const { return states_.size(); }

  // A joint that turns on and on is told within a turn: it leaps by one.
  Result<void> Order(const std::string& place) {
    std::sort(states_.begin(), states_.end());
    states_.erase(std::unique(states_.begin(), states_.end()), states_.end());
    for (size_t k = 1; k < states_.size(); ++k) {
      auto& [stamp, position] = states_[k];
      if (stamp == states_[k - 1].first)
        return Error{place + ": found two positions at the same time, " + Plainly(states_[k - 1].second) + " and " +
                     Plainly(position) + " rad" + (stamp == 0 ? ", and no time stamps" : "") +
                     ", expected one; do two nodes tell it? joint_topic: says which"};
      const double before = states_[k - 1].second;
      if (std::abs(position - before) > std::numbers::pi)
        position = before + std::remainder(position - before, 2 * std::numbers::pi);
    }
    return {};
  }

  // Linear in between; nothing outside.
  std::optional<double> At(double since_first_s) {
    const auto time = [&](const auto& state) { return InSeconds(state.first - states_.front().first); };
    const auto above = std::lower_bound(states_.begin(), states_.end(), since_first_s,
                                        [&](const auto& state, double wanted) { return time(state) < wanted; });
    if (above == states_.end() || (above == states_.begin() && time(*above) != since_first_s)) return std::nullopt;
    if (above == states_.begin()) return above->second;
    const auto below = above - 1;
    const double span = time(*above) - time(*below);
    widest_s_ = std::max(widest_s_, span);
    return below->second + (since_first_s - time(*below)) / span * (above->second - below->second);
  }
  double Since(int64_t stamp_ns) const { return InSeconds(stamp_ns - states_.front().first); }
  double last() const { return Since(states_.back().first); }
  double widest_s() const { return widest_s_; }  // between states that At() went between

 private:
  std::vector<std::pair<int64_t, double>> states_;  // ns, rad
  double widest_s_ = 0;
};

struct ScanTime {
  int64_t stamp_ns = 0;
  double duration_s = 0;
};

// From the first ray to the last.
double DurationOf(const LaserScan& scan) {
  return scan.ranges.empty() ? 0 : scan.time_increment * static_cast<double>(scan.ranges.size() - 1);
}

using OpenBag = Result<std::unique_ptr<RosBag>> (*)(const std::filesystem::path& path);

class RosReader : public ScanReader {
 public:
  RosReader(const ScanFormat& format, OpenBag open, std::string title)
      : format_(format), name_(format.path.string()), open_(open), title_(std::move(title)) {
    if (format.lines) std::tie(first_, last_) = *format.lines;
  }
  int64_t bytes_read() const override { return bag_->bytes_read(); }
  int64_t bytes_total() const override { return bag_->bytes_total(); }
  std::optional<double> FirstProfile() const override { return 1; }
  std::string Describe() const override { return description_; }

  // Looks through the bag once for what is in it.
  Result<void> Begin() {
    SCANCAL_RETURN_IF_ERROR(CheckDeclared());
    SCANCAL_RETURN_IF_ERROR(Survey());
    SCANCAL_RETURN_IF_ERROR(ChooseTopic());
    const std::vector<ScanTime>& scans = scans_[topic_];
    description_ =
        title_ + ": " + std::to_string(scans.size()) + (scans.size() == 1 ? " scan of " : " scans of ") + topic_;
    if (by_joint_) {
      SCANCAL_RETURN_IF_ERROR(ChooseJoint());
      SCANCAL_RETURN_IF_ERROR(Join(scans));
    }
    scans_.clear();
    joints_.clear();
    SCANCAL_ASSIGN_OR_RETURN(bag_, open_(format_.path));
    return {};
  }

  Result<bool> Next(ScanBatch* batch) override {
    batch->names = {"bearing", "range", "profile", "time"};
    if (!format_.wants_angles_from_steps) batch->names.emplace_back("angle");
    batch->columns.resize(batch->names.size());
    for (std::vector<double>& column : batch->columns) column.clear();
    while (batch->size() < kBatchPoints) {
      RosMessage message;
      SCANCAL_ASSIGN_OR_RETURN(const bool more, bag_->Next(&message));
      if (!more) break;
      if (message.topic.name == topic_ && message.topic.type == kLaserScan)
        SCANCAL_RETURN_IF_ERROR(Take(message, batch));
    }
    any_point_ |= batch->size() > 0;
    if (!any_point_ && missing_ == 0) return NoPoints(format_, scan_);
    return batch->size() > 0;
  }

 private:
  Result<void> CheckDeclared() {
    const auto angle = format_.names.find("angle");
    by_ = angle == format_.names.end() ? "" : angle->second;
    by_joint_ = !format_.wants_angles_from_steps && by_.empty();
    if (!by_.empty() && by_ != "time" && by_ != "profile")
      return Error{name_ + ": found no " + Quoted(by_) +
                   " in a bag, expected joint: NAME, whose position is the angle; or "
                   "angle: {file: ..., by: time, ...}, or by: profile, of a file with angles"};
    if (format_.layout) return Error{name_ + ": layout: a bag says itself what a scan is, expected none"};
    if (!format_.text.where.empty()) return Error{name_ + ": where: a bag has no columns, expected keep: {lines: ...}"};
    for (const ScanColumn& column : format_.columns)
      if (column.required && column.name != "angle" && column.name != "profile")
        return Error{name_ + ": found angle, bearing, range, profile and time in a bag, expected also " + column.name,
                     ErrorKind::kMissingColumns};
    return {};
  }

  Result<LaserScan> ScanIn(const RosMessage& message, int64_t number) const {
    LaserScan scan;
    if (!Decode(message, &scan))
      return Error{name_ + ": scan " + std::to_string(number) + " of " + message.topic.name +
                   ": cannot be read as a LaserScan; it is cut off, or serialized otherwise"};
    for (const double value : {scan.angle_min, scan.angle_increment, scan.time_increment})
      if (!std::isfinite(value))
        return Error{name_ + ": scan " + std::to_string(number) + " of " + message.topic.name + ": found " +
                     (std::isnan(value) ? "nan" : "inf") + " for an angle or a time of it, expected a finite number"};
    return scan;
  }

  Result<void> Survey() {
    SCANCAL_ASSIGN_OR_RETURN(const std::unique_ptr<RosBag> bag, open_(format_.path));
    for (RosMessage message;;) {
      SCANCAL_ASSIGN_OR_RETURN(const bool more, bag->Next(&message));
      if (!more) break;
      if (message.topic.type == kLaserScan) {
        std::vector<ScanTime>& scans = scans_[message.topic.name];
        SCANCAL_ASSIGN_OR_RETURN(const LaserScan scan, ScanIn(message, static_cast<int64_t>(scans.size()) + 1));
        scans.push_back({scan.stamp_ns, DurationOf(scan)});
      } else if (by_joint_) {
        SCANCAL_RETURN_IF_ERROR(AddJoints(message));
      }
    }
    for (const RosTopic& topic : bag->topics()) all_.push_back(topic.name + " (" + topic.type + ")");
    return {};
  }

  Result<void> AddJoints(const RosMessage& message) {
    constexpr size_t kMostJoints = 1000;
    JointState state;
    if (!Decode(message, &state))
      return Error{name_ + ": a message of " + message.topic.name +
                   " cannot be read as a JointState; it is cut off, or serialized otherwise"};
    for (size_t k = 0; k < state.positions.size(); ++k) {
      if (!std::isfinite(state.positions[k])) continue;
      joints_[{state.names[k], message.topic.name}].Add(state.stamp_ns, state.positions[k]);
      if (joints_.size() > kMostJoints)
        return Error{name_ + ": found more than 1000 joints, expected those of a machine"};
    }
    return {};
  }

  Result<void> ChooseTopic() {
    std::vector<std::string> found;
    for (const auto& [topic, scans] : scans_) found.push_back(topic);
    topic_ = format_.ros.topic;
    if (topic_.empty() && found.size() == 1) topic_ = found.front();
    if (scans_.contains(topic_)) return {};
    if (found.empty())
      return Error{name_ + ": found no LaserScan in the bag, but " + (all_.empty() ? "nothing" : Listed(all_)) +
                   ", expected messages of " + kLaserScan};
    if (topic_.empty())
      return Error{name_ + ": found scans of " + Listed(found) + ", expected one of them: topic: " + found.front()};
    return Error{name_ + ": topic: found no scan of '" + topic_ + "'" + Suggestion(topic_, found)};
  }

  // Of those that have the names that were declared.
  Result<void> ChooseJoint() {
    std::vector<std::string> names, topics;
    for (const auto& [joint, track] : joints_) {
      const auto& [name, topic] = joint;
      if (names.empty() || names.back() != name) names.push_back(name);
      const bool named = format_.ros.joint.empty() || name == format_.ros.joint;
      if (named && (format_.ros.joint_topic.empty() || topic == format_.ros.joint_topic)) {
        joint_ = &joint;
        topics.push_back(topic);
      }
    }
    if (topics.size() == 1) return {};
    if (joints_.empty())
      return Error{name_ + ": found no position of a joint in the bag, but " + Listed(all_) +
                   ", expected a JointState with the angle of each scan; or angle: {file: ..., by: time, ...}"};
    if (topics.empty() && !format_.ros.joint_topic.empty())
      return Error{name_ + ": found no position of '" + format_.ros.joint + "' in the topic '" +
                   format_.ros.joint_topic + "', expected one; joint: one of " + Listed(names)};
    if (topics.empty())
      return Error{name_ + ": joint: found no joint '" + format_.ros.joint + "'" +
                   Suggestion(format_.ros.joint, names)};
    if (names.size() > 1 && format_.ros.joint.empty())
      return Error{name_ + ": found the joints " + Listed(names) +
                   ", expected the one that turns the scanner: joint: " + names.front()};
    return Error{name_ + ": found the joint in the topics " + Listed(topics) +
                 ", expected one of them: joint_topic: " + topics.front()};
  }

  Result<void> Join(const std::vector<ScanTime>& scans) {
    const auto& [joint, joint_topic] = *joint_;
    track_ = joints_[*joint_];
    SCANCAL_RETURN_IF_ERROR(track_.Order(name_ + ": " + joint + " in " + joint_topic));
    size_t outside = 0;
    double most = 0;
    for (const ScanTime& scan : scans) {
      const double at = track_.Since(scan.stamp_ns);
      const auto from = track_.At(at), to = track_.At(at + scan.duration_s);
      if (from && to) most = std::max(most, std::abs(*to - *from));
      if (!track_.At(at + scan.duration_s / 2)) ++outside;
    }
    if (outside == scans.size())
      return Error{name_ + ": found the scans of " + topic_ + " from " + Plainly(track_.Since(scans.front().stamp_ns)) +
                   " to " + Plainly(track_.Since(scans.back().stamp_ns)) + " s, and " + joint + " from 0 to " +
                   Plainly(track_.last()) + " s of its clock, expected both at the same time; do their clocks agree?"};
    description_ += ", angle from " + joint + " in " + joint_topic + " in the middle of each";
    if (outside > 0) description_ += ", " + std::to_string(outside) + " outside of its time left out";
    description_ += "; it turns by up to " + Rounded(most * kDegrees_per_rad) +
                    " deg within a scan, and is told at least every " + Rounded(track_.widest_s()) + " s";
    return {};
  }

  static std::string Rounded(double number) {  // two digits
    if (number == 0) return "0";
    const double unit = std::pow(10, std::floor(std::log10(std::abs(number))) - 1);
    return Plainly(std::round(number / unit) * unit);
  }

  Result<void> Take(const RosMessage& message, ScanBatch* batch) {
    SCANCAL_ASSIGN_OR_RETURN(const LaserScan scan, ScanIn(message, scan_ + 1));
    if (scan_++ == 0) begin_ns_ = scan.stamp_ns;
    if (scan_ < first_ || scan_ > last_) return {};
    double angle = by_ == "time" ? InSeconds(scan.stamp_ns) : static_cast<double>(scan_);
    if (by_joint_) {
      const auto position = track_.At(track_.Since(scan.stamp_ns) + DurationOf(scan) / 2);
      if (!position) return {};
      angle = *position;
    }
    const double point[] = {0, 0, static_cast<double>(scan_), InSeconds(scan.stamp_ns - begin_ns_), angle};
    for (size_t k = 0; k < scan.ranges.size(); ++k) {
      const double range = scan.ranges[k];
      // REP 117: -inf too near, inf nothing seen, nan no measurement.
      const bool within =
          std::isfinite(range) && range >= scan.range_min && (range <= scan.range_max || !(scan.range_max > 0));
      const std::vector<double>& more = format_.more_invalid;
      if (!within || range == format_.invalid || std::count(more.begin(), more.end(), range) > 0) {
        ++missing_;
        continue;
      }
      batch->columns[0].push_back(scan.angle_min + scan.angle_increment * static_cast<double>(k));
      batch->columns[1].push_back(range * kMillimetre_per_m);
      for (size_t c = 2; c < batch->columns.size(); ++c) batch->columns[c].push_back(point[c]);
    }
    return {};
  }

  const ScanFormat format_;
  std::string name_;
  OpenBag open_;
  std::string title_, description_;
  std::string by_;  // in place of an angle: what joins a file of angles
  bool by_joint_ = true;
  std::map<std::string, std::vector<ScanTime>> scans_;                // of each topic
  std::map<std::pair<std::string, std::string>, JointTrack> joints_;  // name, topic
  const std::pair<std::string, std::string>* joint_ = nullptr;        // among them
  std::vector<std::string> all_;                                      // topics with their types
  std::string topic_;
  JointTrack track_;
  std::unique_ptr<RosBag> bag_;
  int64_t first_ = 1, last_ = std::numeric_limits<int64_t>::max(), scan_ = 0;
  int64_t begin_ns_ = 0;
  bool any_point_ = false;
};

Result<std::unique_ptr<ScanReader>> OpenRos(const ScanFormat& format, OpenBag open, const char* title) {
  auto reader = std::make_unique<RosReader>(format, open, title);
  SCANCAL_RETURN_IF_ERROR(reader->Begin());
  return std::unique_ptr<ScanReader>(std::move(reader));
}

constexpr std::string_view kSqliteStart = "SQLite format 3", kMcapStart = "\x89MCAP";

bool IsRos1(std::string_view start, const ScanFormat& /*format*/) { return start.starts_with("#ROSBAG V"); }
bool IsRos2(std::string_view start, const ScanFormat& /*format*/) {
  return start.starts_with(kSqliteStart) || start.starts_with(kMcapStart);
}

Result<std::unique_ptr<ScanReader>> OpenRos1(const ScanFormat& format) {
  if (IsReadOnce(format.path))
    return Error{format.path.string() + ": found a pipe, expected a file: a bag is read twice"};
  return OpenRos(format, &OpenRos1Bag, "ROS 1 bag");
}
Result<std::unique_ptr<ScanReader>> OpenRos2(const ScanFormat& format) {
  SCANCAL_ASSIGN_OR_RETURN(const std::string start, FirstBytes(format.path, 16));
  if (start.starts_with(kMcapStart))
    return Error{
        format.path.string() +
        ": found a bag in MCAP, expected one in SQLite or a ROS 1 bag; ros2 bag convert writes it so (storage_id: "
        "sqlite3)"};
  if (!start.starts_with(kSqliteStart))
    return Error{format.path.string() + ": found other data, expected a ROS 2 bag in SQLite, a .db3 file"};
  return OpenRos(format, &OpenRos2Bag, "ROS 2 bag");
}

}  // namespace

const FileKind kRos1 = {"ros1", "ROS 1 bags", &IsRos1, &OpenRos1};
const FileKind kRos2 = {"ros2", "ROS 2 bags", &IsRos2, &OpenRos2};

}  // namespace scancal
