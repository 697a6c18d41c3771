// scancal planes: the placements of an uncropped scan, proposed, looked at, and used.
#include <gmock/gmock.h>
#include "tests/cli/data_set.h"
#include "tests/cli/room_scene.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr char kTarget[] = "the \"big\" room: 1";

class PlanesTest : public CliTest {
 protected:
  void SetUp() override { Write(Scanned(2)); }

  static std::vector<RoomPoint> Scanned(unsigned seed, bool planes = true) {
    Room room(seed);
    room.profiles = 100;
    room.points = 80;
    room.planes = planes;
    return room.Scan();
  }

  void Write(const std::vector<RoomPoint>& points) const {
    fs::create_directories(data_);
    std::vector<std::vector<double>> rows;
    for (const RoomPoint& p : points) rows.push_back({p.angle, p.y, p.z});
    WriteTable(data_ / "room.csv", "angle,y,z", rows);
    Declare("find");
  }

  void Declare(const std::string& planes, const std::string& more = "") const {
    WriteWhole(data_ / "dataset.yaml",
               "scancal: 1\nmodel: turntable\nunits: {length: mm, angle: deg}\nrotation: clockwise\n"
               "search: {M: [117, 137], N: [395, 417], step: 1}\nplanes: " +
                   planes + "\n" + more + "targets:\n  - {name: '" + kTarget + "', scan: room.csv}\n");
  }

  Outcome Find() const { return RunScancal({"planes", data_.string(), "--out=" + data_.string()}); }

  // Finds, changes the file, and returns why it is refused.
  std::string RefusalWith(const std::string& from, const std::string& to) const {
    WriteWhole(data_ / "planes.yaml", found_);
    Replace(data_ / "planes.yaml", from, to);
    const Outcome outcome = Refine(data_);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
    return OneSentence(outcome);
  }

  const fs::path data_ = Path("a room");
  std::string found_;
};

TEST_F(PlanesTest, TheyAreFoundLookedAtAndUsed) {
  EXPECT_THAT(OneSentence(Refine(data_)), AllOf(HasSubstr("dataset.yaml:6:9: planes: found find"),
                                                HasSubstr("scancal planes " + data_.string() + " --out=FOLDER")));
  const Outcome outcome = Find();
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("planes in "), HasSubstr("plane 1 up"), HasSubstr("planes: planes.yaml")));
  const std::string page = ReadWhole(data_ / "planes.html");
  EXPECT_THAT(page, AllOf(HasSubstr("<h2>the &quot;big&quot; room: 1</h2>"), HasSubstr("data:image/png;base64,iVBOR")));
  EXPECT_THAT(OneSentence(Find()), HasSubstr("planes.yaml: is there already"));

  Declare("planes.yaml");
  const Json result = Refined(data_);
  EXPECT_NEAR(ValueOf(result, "M"), 123, 3 * UOf(result, "M"));
  EXPECT_NEAR(ValueOf(result, "N"), 409, 3 * UOf(result, "N"));
  EXPECT_EQ(result["targets"][0]["name"], std::string(kTarget) + " plane 1 up");
  ASSERT_EQ(result["inputs"].size(), 3U);
  EXPECT_EQ(result["inputs"][1]["file"], "planes.yaml");
  // Years later, without scan and planes.
  fs::copy(Path("out") / "calibration.json", Path("kept.json"));
  fs::remove_all(data_);
  EXPECT_EQ(Refine(Path("kept.json")).exit_code, 0);
  EXPECT_EQ(Result()["parameters"], result["parameters"]);
}

TEST_F(PlanesTest, TheFileIsTheUsersUntilItContradictsTheScan) {
  ASSERT_EQ(Find().exit_code, 0);
  Declare("planes.yaml");
  found_ = ReadWhole(data_ / "planes.yaml");
  const size_t second = found_.find("      - name: ", found_.find("- name: ") + 8);
  const std::string first = found_.substr(found_.find("      - name: "), second - found_.find("      - name: "));

  WriteWhole(data_ / "planes.yaml", found_);
  Replace(data_ / "planes.yaml", "\"plane 1 up\"", "left wall");
  Replace(data_ / "planes.yaml", found_.substr(found_.rfind("      - name: ")), "");
  const Json result = Refined(data_);
  EXPECT_EQ(result["targets"][0]["name"], std::string(kTarget) + " left wall");

  const auto with_runs = [&](const std::string& runs) {
    return first.substr(0, first.find("runs: |")) + "runs: " + runs + "\n";
  };
  EXPECT_THAT(RefusalWith("\"plane 1 up\"", "\"plane 1 down\""), HasSubstr("expected a name that no other plane"));
  EXPECT_THAT(RefusalWith("\"plane 1 up\"", "''"), HasSubstr("expected a name"));
  EXPECT_THAT(RefusalWith(first, with_runs("5-4")), HasSubstr("expected numbers of points, ascending"));
  EXPECT_THAT(RefusalWith(first, with_runs("1-99999999999999999999")), HasSubstr("expected numbers of points"));
  EXPECT_THAT(RefusalWith(first, with_runs("1-99999999")), HasSubstr("the points of the scan"));
  EXPECT_THAT(RefusalWith(first, with_runs("1-5")), HasSubstr("as many as its runs hold"));
  EXPECT_THAT(RefusalWith("runs: |", "rums: |"), HasSubstr("runs"));
  EXPECT_THAT(RefusalWith("checksum: \"", "checksum: \"0"), HasSubstr("another scan"));
  EXPECT_THAT(RefusalWith("- target: \"the", "- target: \"a"),
              HasSubstr("has no planes of target " + std::string(kTarget)));
  EXPECT_THAT(RefusalWith("scancal: 1", "scancal: 2"), HasSubstr("expected 1, the version"));
  std::string again = first;
  again.replace(again.find("plane 1"), 7, "another");
  EXPECT_THAT(RefusalWith(first, first + again), HasSubstr("expected every point once"));
  WriteWhole(data_ / "planes.yaml", found_.substr(0, found_.size() - 40));
  EXPECT_THAT(OneSentence(Refine(data_)), HasSubstr("planes.yaml:"));

  WriteWhole(data_ / "planes.yaml", found_);
  Declare("planes.yaml", "keep: {lines: [2, 9000]}\n");
  EXPECT_EQ(Refine(data_).exit_code, 1);  // keep is a target's
  Declare("planes.yaml", "invalid: 1\n");
  Refined(data_);  // leaves no point out
  std::vector<RoomPoint> points = Scanned(2);
  points[100].y += 0.001;
  Write(points);
  Declare("planes.yaml");
  EXPECT_THAT(OneSentence(Refine(data_)),
              AllOf(HasSubstr("plane 1 up: found in a scan of"), HasSubstr("run scancal planes again")));
}

TEST_F(PlanesTest, WhatHoldsNoneSaysSo) {
  Write(Scanned(2, /*planes=*/false));
  EXPECT_THAT(OneSentence(Find()), HasSubstr("no plane was found; "));
  EXPECT_TRUE(fs::exists(data_ / "planes.html"));
  EXPECT_FALSE(fs::exists(data_ / "planes.yaml"));
  std::vector<RoomPoint> points = Scanned(2);
  for (RoomPoint& p : points) p.angle = 3;
  points.resize(80);
  Write(points);
  EXPECT_THAT(OneSentence(Find()), HasSubstr("found 1 profiles, expected a scan of at least 12 profiles"));
  for (RoomPoint& p : points) p.y = std::nan("");
  Write(points);
  EXPECT_EQ(Find().exit_code, 1);
  Declare("\"\"");
  EXPECT_THAT(OneSentence(Find()), HasSubstr("expected find, or the path of a file of planes"));
  Declare("nowhere.yaml");
  EXPECT_THAT(OneSentence(Refine(data_)), HasSubstr("nowhere.yaml"));
  EXPECT_THAT(OneSentence(RunScancal({"planes", MakeData().string()})), HasSubstr("no target says planes: find"));
  EXPECT_THAT(OneSentence(RunScancal({"planes", SCANCAL_SOURCE_DIR "/data/robot-sample"})),
              HasSubstr("expected turntable: no other scans planes"));
}

}  // namespace
}  // namespace scancal
