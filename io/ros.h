// Bags of ROS messages: what they hold of LaserScans and JointStates.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>
#include "io/result.h"

namespace scancal {

inline constexpr char kLaserScan[] = "sensor_msgs/LaserScan", kJointState[] = "sensor_msgs/JointState";

struct RosTopic {
  std::string name;  // "/scan"
  std::string type;  // "sensor_msgs/LaserScan", also of ROS 2
};

struct RosMessage {
  RosTopic topic;
  std::string_view data;  // until the next one
  bool cdr = false;       // as ROS 2 writes it
};

// Message by message, as it was recorded.
class RosBag {
 public:
  virtual ~RosBag() = default;
  // The next LaserScan or JointState; false at the end.
  virtual Result<bool> Next(RosMessage* message) = 0;
  virtual std::vector<RosTopic> topics() const = 0;  // all that were seen so far; at the end all there are
  virtual int64_t bytes_read() const = 0;
  virtual int64_t bytes_total() const = 0;
};

// A ROS 1 bag, format 2.0 (wiki.ros.org/Bags/Format/2.0), with chunks as they are, in bz2 or in lz4.
Result<std::unique_ptr<RosBag>> OpenRos1Bag(const std::filesystem::path& path);
// A ROS 2 bag in SQLite (rosbag2_storage_sqlite3: tables topics and messages), serialized as CDR.
Result<std::unique_ptr<RosBag>> OpenRos2Bag(const std::filesystem::path& path);

struct LaserScan {
  int64_t stamp_ns = 0;                                                                         // of the first ray
  double angle_min = 0, angle_increment = 0, time_increment = 0, range_min = 0, range_max = 0;  // rad, s, m
  std::vector<float> ranges;                                                                    // m
};
struct JointState {
  int64_t stamp_ns = 0;
  std::vector<std::string> names;
  std::vector<double> positions;  // rad; as many as names, or fewer
};
// False: the message is cut off, or of another layout.
bool Decode(const RosMessage& message, LaserScan* scan);
bool Decode(const RosMessage& message, JointState* state);

}  // namespace scancal
