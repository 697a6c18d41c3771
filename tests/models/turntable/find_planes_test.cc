// Planes found in uncropped scans of rooms, and what a calibration with them finds.
#include "models/turntable/find_planes.h"
#include <gtest/gtest.h>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numeric>
#include <string>
#include <vector>
#include "models/turntable/scanner.h"
#include "tests/cli/room_scene.h"

namespace scancal::turntable {
namespace {

struct ScannedRoom {
  RangeImage image;
  std::vector<int> surface;  // of each point
};

ScannedRoom ImageOf(const std::vector<RoomPoint>& points) {
  ScannedRoom room;
  RangeImage& image = room.image;
  image.name = "room";
  double angle = std::nan("");
  for (const RoomPoint& p : points) {
    if (p.angle != angle) image.alpha.push_back(p.angle * kDegree);
    angle = p.angle;
    if (std::isnan(p.y)) continue;
    image.y.push_back(p.y);
    image.z.push_back(p.z);
    image.row.push_back(static_cast<int32_t>(image.alpha.size()) - 1);
    image.number.push_back(std::ssize(image.y));
    room.surface.push_back(p.surface);
  }
  const Result<void> made = MakeImage(image.z, "room.csv", &image);
  EXPECT_TRUE(made.ok()) << made.error().message;
  return room;
}

Declaration Around(double M, double N) {
  Declaration declaration;
  declaration.search = {{M - 6, N - 14}, {M + 14, N + 8}, 1};
  return declaration;
}

FoundPlanes FindIn(const ScannedRoom& room, const Room& truth) {
  return FindPlanes({room.image}, Around(truth.M, truth.N), Model(Model::Residuals::kDepth), [](double) {});
}

Calibration CalibratedWith(const ScannedRoom& room, const FoundPlanes& found, const Room& truth) {
  std::vector<RawScan> scans;
  for (const FoundPlane& plane : found.scans[0].planes) {
    scans.push_back(ScanOf(room.image, plane, NameOf(room.image, plane)));
    Clean(&scans.back());
  }
  const auto scanner = Compress(Around(truth.M, truth.N), Model(Model::Residuals::kDepth), scans);
  EXPECT_TRUE(scanner.ok());
  if (!scanner.ok()) return {};
  RefineChoice choice;
  choice.figures = false;
  const auto result = (*scanner)->Calibrate(choice);
  EXPECT_TRUE(result.ok()) << result.error().message;
  return result.ok() ? *result : Calibration();
}

// Of a plane's points the share that lie on its most frequent surface.
double Purity(const ScannedRoom& room, const FoundPlane& plane, int* surface) {
  std::map<int, int> counts;
  for (const int32_t p : plane.points) ++counts[room.surface[static_cast<size_t>(p)]];
  const auto most =
      std::max_element(counts.begin(), counts.end(), [](auto& a, auto& b) { return a.second < b.second; });
  *surface = most->first;
  return static_cast<double>(most->second) / static_cast<double>(plane.points.size());
}

// SCANCAL_ROOMS=400 counts more of them, and prints.
TEST(FindPlanes, MAndNOfRoomsAreWithinU) {
  const char* const wanted = std::getenv("SCANCAL_ROOMS");
  const unsigned rooms = wanted ? static_cast<unsigned>(std::atoi(wanted)) : 6;
  int within[2] = {0, 0};
  double squares[2] = {0, 0};
  int unreliable = 0, few = 0;
  for (unsigned seed = 1; seed <= rooms; ++seed) {
    Room truth(seed);
    const ScannedRoom room = ImageOf(truth.Scan());
    const FoundPlanes found = FindIn(room, truth);
    ASSERT_EQ(room.image.sweeps.size(), 2U);
    few += static_cast<int>(found.scans[0].planes.size() < 8);
    for (const FoundPlane& plane : found.scans[0].planes) {
      int surface = 0;
      EXPECT_GT(Purity(room, plane, &surface), 0.99) << "room " << seed << ", " << NameOf(room.image, plane);
      EXPECT_GT(surface, 0) << "a curved thing of room " << seed << " is no plane";
      for (const int32_t p : plane.points) {
        const int32_t row = room.image.row[static_cast<size_t>(p)];
        ASSERT_TRUE(row >= room.image.sweeps[plane.sweep].first && row < room.image.sweeps[plane.sweep].second);
      }
    }
    const Calibration c = CalibratedWith(room, found, truth);
    unreliable += static_cast<int>(!c.ok());
    for (const size_t k : {0, 1}) {
      const Parameter* p = c.Find(k == 0 ? "M" : "N");
      ASSERT_NE(p, nullptr);
      const double error = p->value - (k == 0 ? truth.M : truth.N);
      within[k] += static_cast<int>(std::abs(error) <= p->U);
      squares[k] += std::pow(error / p->u, 2) / rooms;
      if (wanted && std::abs(error) > p->U)
        printf("room %u: %s off by %.4f, U %.4f\n", seed, k ? "N" : "M", error, p->U);
    }
  }
  if (wanted)
    printf(
        "%u rooms: M within U in %.1f %%, N in %.1f %%; rms of error / u %.2f, %.2f; %d unreliable, %d with few "
        "planes\n",
        rooms, 100.0 * within[0] / rooms, 100.0 * within[1] / rooms, std::sqrt(squares[0]), std::sqrt(squares[1]),
        unreliable, few);
  // Of 6 rooms at 95 %: less than 4 within with a probability of 0.2 %; rms of error / u beyond 2 with less than 0.1 %.
  EXPECT_GE(within[0], 0.93 * rooms - 2);
  EXPECT_GE(within[1], 0.93 * rooms - 2);
  EXPECT_LT(squares[0], 4);
  EXPECT_LT(squares[1], 4);
  EXPECT_EQ(unreliable, 0);
  EXPECT_EQ(few, 0);
}

TEST(FindPlanes, CurvedThingsAreNone) {
  Room truth(3);
  truth.planes = false;
  const ScannedRoom room = ImageOf(truth.Scan());
  const FoundPlanes found = FindIn(room, truth);
  EXPECT_TRUE(found.scans[0].planes.empty()) << found.scans[0].planes.size();
  EXPECT_FALSE(found.refined);
}

TEST(FindPlanes, TheyAreTheSameAgain) {
  Room truth(4);
  const ScannedRoom room = ImageOf(truth.Scan());
  const FoundPlanes once = FindIn(room, truth), again = FindIn(room, truth);
  ASSERT_EQ(once.scans[0].planes.size(), again.scans[0].planes.size());
  for (size_t k = 0; k < once.scans[0].planes.size(); ++k)
    EXPECT_EQ(once.scans[0].planes[k].points, again.scans[0].planes[k].points);
  EXPECT_NEAR(once.system.M(), truth.M, 0.1);
  EXPECT_NEAR(once.system.N(), truth.N, 0.1);
}

TEST(FindPlanes, OnePlaneHasOneNumberInBothSweeps) {
  Room truth(5);
  const ScannedRoom room = ImageOf(truth.Scan());
  std::map<int, std::vector<int>> surfaces;
  const FoundPlanes found = FindIn(room, truth);
  for (const FoundPlane& plane : found.scans[0].planes) {
    int surface = 0;
    Purity(room, plane, &surface);
    surfaces[plane.number].push_back(surface);
  }
  size_t twice = 0;
  for (const auto& [number, of] : surfaces) {
    twice += static_cast<size_t>(of.size() == 2);
    for (const int each : of) EXPECT_EQ(each, of.front()) << number;
  }
  EXPECT_GE(twice, 4U);
}

}  // namespace
}  // namespace scancal::turntable
