// Bags of ROS 1 and 2: LaserScans joined with JointStates.
#include <gmock/gmock.h>
#include <cmath>
#include <limits>
#include "tests/io/ros_bags.h"
#include "tests/io/scan_test.h"

namespace scancal {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();

class RosTest : public ScanFileTest, public ::testing::WithParamInterface<bool> {
 protected:
  bool cdr() const { return GetParam(); }
  ScanFormat Of(const std::vector<BagMessage>& messages) {
    ScanFormat format = Format("run.bag", cdr() ? "" : Ros1BagOf(messages));
#ifdef SCANCAL_SQLITE
    if (cdr()) format.path = WriteRos2Bag(folder_, "run #1 100%.db3", messages);
#endif
    return format;
  }
  void SetUp() override {
#ifndef SCANCAL_SQLITE
    if (cdr()) GTEST_SKIP() << "NOT TESTED: built without SQLite (libsqlite3-dev), bags of ROS 2 are not read";
#endif
  }
  BagMessage Scan(double time_s, const std::vector<float>& ranges, float time_increment = 0) const {
    return ScanMessage(cdr(), time_s, ranges, time_increment);
  }
  BagMessage Joint(double time_s, double position) const {
    return JointMessage(cdr(), time_s, {"other", "tilt"}, {9, position});
  }
  ScanFormat Tilt(const std::vector<BagMessage>& messages) {
    ScanFormat format = Of(messages);
    format.ros.joint = "tilt";
    return format;
  }
};

TEST_P(RosTest, AScanIsAProfileAtThePositionOfTheJoint) {
  const BagMessage picture = {"/camera", "sensor_msgs/Image", std::string(5000, '?')};
  const scancal::Scan scan =
      ReadAll(Tilt({picture, Joint(100, 0.1), Scan(100.25, {1, kInf, 2}), picture, Joint(101, 0.5),
                    Scan(101.5, {0.25F, kNan, 3, 11, -kInf, 4}), Joint(102, 0.9)}));
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan["bearing"], ElementsAre(-0.5, 0, 0, 0.75));
  EXPECT_THAT(scan["range"], ElementsAre(1000, 2000, 3000, 4000));
  EXPECT_THAT(scan["angle"],
              ElementsAre(DoubleNear(0.2, 1e-9), DoubleNear(0.2, 1e-9), DoubleNear(0.7, 1e-9), DoubleNear(0.7, 1e-9)));
  EXPECT_THAT(scan["profile"], ElementsAre(1, 1, 2, 2));
  EXPECT_THAT(scan["time"], ElementsAre(0, 0, DoubleNear(1.25, 1e-9), DoubleNear(1.25, 1e-9)));
  EXPECT_EQ(scan.missing, 5);
  EXPECT_EQ(scan.description, std::string(cdr() ? "ROS 2" : "ROS 1") +
                                  " bag: 2 scans of /scan, angle from tilt in /joint_states in the middle of each; it "
                                  "turns by up to 0 deg within a scan, and is told at least every 1 s");
}

TEST_P(RosTest, TheMiddleOfAScanCountsAndWhatIsOutsideIsLeftOut) {
  const scancal::Scan scan = ReadAll(Tilt({Scan(99, {1}), Joint(100, 3.1), Scan(100, {1, 2, 3}, 0.5F), Joint(102, -3.1),
                                           Joint(101, 3.13), Scan(102.1, {1})}));
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan["profile"], ElementsAre(2, 2, 2));
  EXPECT_THAT(scan["angle"], ElementsAre(DoubleNear(3.115, 1e-9), DoubleNear(3.115, 1e-9), DoubleNear(3.115, 1e-9)));
  EXPECT_THAT(scan.description,
              HasSubstr("in the middle of each, 2 outside of its time left out; it turns by up to 1.7 "
                        "deg within a scan"));
  // Beyond half a turn it goes on.
  EXPECT_NEAR(ReadAll(Tilt({Joint(100, 3.1), Scan(100.5, {1}), Joint(101, -3.1)}))["angle"][0], M_PI, 1e-9);
}

TEST_P(RosTest, WhatIsAmbiguousIsNamed) {
  std::vector<BagMessage> messages = {Joint(1, 0), Joint(3, 1), Scan(2, {1})};
  EXPECT_THAT(ReadAll(Of(messages)).error, HasSubstr(": found the joints other, tilt, expected the one that turns the "
                                                     "scanner: joint: other"));
  messages.push_back(ScanMessage(cdr(), 2, {5}, 0, "/back"));
  ScanFormat format = Tilt(messages);
  EXPECT_THAT(ReadAll(format).error, HasSubstr(": found scans of /back, /scan, expected one of them: topic: /back"));
  format.ros.topic = "/scam";
  EXPECT_THAT(ReadAll(format).error, HasSubstr(": topic: found no scan of '/scam', did you mean '/scan'?"));
  format.ros.topic = "/back";
  EXPECT_THAT(ReadAll(format)["range"], ElementsAre(5000));
  format.ros.joint = "tild";
  EXPECT_THAT(ReadAll(format).error, HasSubstr(": joint: found no joint 'tild', did you mean 'tilt'?"));
  messages.push_back(JointMessage(cdr(), 2, {"tilt"}, {7}, "/measured"));
  format = Tilt(messages);
  format.ros.topic = "/scan";
  EXPECT_THAT(ReadAll(format).error, HasSubstr(": found the joint in the topics /joint_states, /measured, expected one "
                                               "of them: joint_topic: /joint_states"));
  format.ros.joint_topic = "/measured";
  EXPECT_THAT(ReadAll(format)["angle"], ElementsAre(7));
  format.ros.joint_topic = "/none";
  EXPECT_THAT(ReadAll(format).error, HasSubstr(": found no position of 'tilt' in the topic '/none', expected one"));
}

TEST_P(RosTest, WhatIsNotThereIsTold) {
  EXPECT_THAT(ReadAll(Tilt({Joint(1, 0)})).error, HasSubstr(": found no LaserScan in the bag, but /joint_states "
                                                            "(sensor_msgs/JointState), expected messages of "));
  EXPECT_THAT(ReadAll(Tilt({Scan(1, {1})})).error, HasSubstr(": found no position of a joint in the bag, but /scan ("));
  EXPECT_THAT(
      ReadAll(Tilt({Joint(1, 0), Joint(2, 1), Scan(3, {1}), Scan(4, {1})})).error,
      HasSubstr(": found the scans of /scan from 2 to 3 s, and tilt from 0 to 1 s of its clock, expected both at "
                "the same time; do their clocks agree?"));
  EXPECT_THAT(
      ReadAll(Tilt({Joint(0, 0), Joint(0, 1), Scan(3, {1})})).error,
      HasSubstr(": tilt in /joint_states: found two positions at the same time, 0 and 1 rad, and no time stamps"));
}

TEST_P(RosTest, AnglesFromElsewhere) {
  const std::vector<BagMessage> messages = {Scan(100, {1}), Scan(101, {2}), Scan(102, {3})};
  ScanFormat format = Of(messages);
  format.angle = Steps(1, 0.5);
  format.lines = {2, 3};
  EXPECT_THAT(ReadAll(format)["angle"], ElementsAre(1.5, 2));
  format.angle = Counts("Encoder");
  EXPECT_THAT(ReadAll(format).error, HasSubstr(": found no \"Encoder\" in a bag, expected joint: NAME"));
  format.angle->file = folder_.Write("angles.csv", "time,Encoder\n100,10\n102,14\n");
  format.angle->by = "time";
  EXPECT_THAT(ReadAll(format)["angle"], ElementsAre(6, 7));
  format.layout = WideLayout{.value = "y", .across = "z"};
  EXPECT_THAT(ReadAll(format).error, HasSubstr(": layout: a bag says itself what a scan is"));
  format.layout.reset();
  format.text.where = {{"a", "b"}};
  EXPECT_THAT(ReadAll(format).error, HasSubstr(": where: a bag has no columns"));
}

TEST_P(RosTest, CutOffMessagesAreTold) {
  BagMessage scan = Scan(1, {1, 2, 3}), joint = Joint(1, 0);
  for (size_t size = 0; size + 4 < scan.data.size(); size += 3) {  // the intensities at its end are not read
    const std::string error =
        ReadAll(Tilt({joint, Joint(2, 0), {scan.topic, scan.type, scan.data.substr(0, size)}})).error;
    EXPECT_THAT(error, HasSubstr(": scan 1 of /scan: cannot be read as a LaserScan")) << size;
  }
  joint.data.resize(joint.data.size() - 20);
  EXPECT_THAT(ReadAll(Tilt({joint, scan})).error,
              HasSubstr(": a message of /joint_states cannot be read as a JointState"));
}

INSTANTIATE_TEST_SUITE_P(Bags, RosTest, ::testing::Bool(),
                         [](const auto& info) { return std::string(info.param ? "Ros2" : "Ros1"); });

class Ros1Test : public ScanFileTest {
 protected:
  scancal::Scan Read(const std::string& bytes) {
    ScanFormat format = Format("run.bag", bytes);
    format.ros.joint = "tilt";
    return ReadAll(format);
  }
  const std::vector<BagMessage> messages_ = {JointMessage(false, 1, {"tilt"}, {0}), ScanMessage(false, 2, {1, 2}),
                                             JointMessage(false, 3, {"tilt"}, {1})};
};

TEST_F(Ros1Test, ChunksArePackedOrNot) {
  for (const char* compression : {"none", "bz2", "lz4"}) {
    const scancal::Scan scan = Read(Ros1BagOf(messages_, compression));
    EXPECT_THAT(scan.error, IsEmpty()) << compression;
    EXPECT_THAT(scan["range"], ElementsAre(1000, 2000)) << compression;
  }
  EXPECT_THAT(Read(Ros1BagOf(messages_, "zip")).error,
              HasSubstr(": found a chunk packed as \"zip\", expected none, bz2 or lz4; rosbag decompress writes it"));
}

TEST_F(Ros1Test, LengthsAreNotTrusted) {
  const std::string bag = Ros1BagOf(messages_);
  for (size_t size = 13; size < bag.size(); size += 31) {
    const std::string error = Read(bag.substr(0, size)).error;
    EXPECT_THAT(error, HasSubstr("run.bag: ")) << size;
  }
  for (const char* packed : {"bz2", "lz4"}) {
    std::string damaged = Ros1BagOf(messages_, packed);
    damaged[damaged.size() - 90] ^= 1;
    EXPECT_THAT(Read(damaged).error, HasSubstr(std::string(": a chunk cannot be unpacked from ") + packed)) << packed;
  }
  std::string longer = bag;
  longer.replace(longer.find("#ROSBAG V2.0\n") + 13, 4, "\xff\xff\xff\xff");
  EXPECT_THAT(Read(longer).error, HasSubstr(": the file is cut off, expected whole records; rosbag reindex"));
}

TEST_F(Ros1Test, OtherBagsAreRefused) {
  EXPECT_THAT(Read("#ROSBAG V1.2\n").error, HasSubstr(": found other data, expected the line #ROSBAG V2.0"));
  EXPECT_THAT(Read(std::string("\x89MCAP0\r\n", 8)).error, HasSubstr(": found a bag in MCAP, expected one in SQLite"));
  ScanFormat format = Format("a.csv", "angle,y,z\n1,2,3\n");
  format.kind = "ros2";
  EXPECT_THAT(ReadAll(format).error, HasSubstr(": found other data, expected a ROS 2 bag in SQLite, a .db3 file"));
}

#ifdef SCANCAL_SQLITE
class Ros2Test : public ScanFileTest {
 protected:
  std::string ErrorOf(const std::filesystem::path& path) {
    ScanFormat format = Format("unused", "");
    format.path = path;
    return ReadAll(format).error;
  }
  std::string ErrorOfSql(const std::string& sql) {
    const std::filesystem::path path = folder_.Write("run.db3", "");
    sqlite3* bag = nullptr;
    sqlite3_open(path.c_str(), &bag);
    sqlite3_exec(bag, sql.c_str(), nullptr, nullptr, nullptr);
    sqlite3_close(bag);
    return ErrorOf(path);
  }
  const std::vector<BagMessage> messages_ = {JointMessage(true, 1, {"tilt"}, {0}), ScanMessage(true, 2, {1, 2}),
                                             JointMessage(true, 3, {"tilt"}, {1})};
};

TEST_F(Ros2Test, TheOnlyJointAndEitherOrderOfBytes) {
  std::vector<BagMessage> messages = messages_;
  messages.push_back(ScanMessage(true, 2.5, {3}, 0, "/scan", true));
  ScanFormat format = Format("unused", "");
  format.path = WriteRos2Bag(folder_, "run.db3", messages);
  const scancal::Scan scan = ReadAll(format);
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan["range"], ElementsAre(1000, 2000, 3000));
  EXPECT_THAT(scan["angle"], ElementsAre(0.5, 0.5, 0.75));
}

TEST_F(Ros2Test, WhatIsNoBagOfCdrIsTold) {
  EXPECT_THAT(ErrorOf(WriteRos2Bag(folder_, "run.db3", messages_, "protobuf")),
              HasSubstr(": topic \"/joint_states\": found the serialization format \"protobuf\", expected cdr"));
  std::vector<BagMessage> packed = messages_;
  packed[1].data.replace(0, 4, "\x28\xb5\x2f\xfd");
  EXPECT_THAT(ErrorOf(WriteRos2Bag(folder_, "run.db3", packed)), HasSubstr(": found messages packed as zstd"));
  EXPECT_THAT(ErrorOfSql("CREATE TABLE t(a)"), HasSubstr("without the tables topics and messages"));
}

TEST_F(Ros2Test, ASchemaIsNotTrusted) {
  EXPECT_THAT(ErrorOfSql("CREATE TABLE topics(id,name,type,serialization_format);"
                         "CREATE VIEW messages AS WITH RECURSIVE r(x) AS (SELECT 1 UNION ALL SELECT x+1 FROM r) "
                         "SELECT x AS topic_id, x AS data FROM r"),
              HasSubstr("without the tables topics and messages"));
  EXPECT_THAT(
      ErrorOfSql("CREATE TABLE topics(id,name,type,serialization_format);"
                 "INSERT INTO topics VALUES(1,'/scan','sensor_msgs/msg/LaserScan','cdr');"
                 "CREATE TABLE messages(topic_id,data AS (zeroblob(900000000)));INSERT INTO messages VALUES(1)"),
      HasSubstr("cannot be read as a ROS 2 bag: string or blob too big"));
}

TEST_F(Ros2Test, AFileThatIsCutOffIsTold) {
  const std::string bytes = folder_.Read(WriteRos2Bag(folder_, "run.db3", messages_).filename());
  EXPECT_THAT(ErrorOf(folder_.Write("cut.db3", bytes.substr(0, bytes.size() / 2))),
              HasSubstr("cannot be read as a ROS 2 bag: database disk image is malformed"));
}
#endif

}  // namespace
}  // namespace scancal
