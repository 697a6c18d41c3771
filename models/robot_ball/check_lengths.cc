// The lengths that a calibration is checked with.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include "io/message.h"
#include "models/robot_ball/tables.h"

namespace scancal::robot_ball {
namespace {

constexpr Message<std::string_view, size_t, size_t> kLengthsOfOnePose{
    "robot_ball.lengths_of_one_pose",
    "{}: {} of {} lengths were seen from one pose: they test the scanner, not the robot",
    "{}: {} von {} Längen wurden aus einer einzigen Pose gesehen: Sie prüfen den Scanner, nicht den Roboter"};

constexpr double kMostOff = 0.4;  // logarithm of half as much again

struct BallPair {
  int a, b;
  double distance, u;
  size_t row;
};

struct Pairs {
  Table table;
  std::vector<std::string> balls;
  std::vector<BallPair> pairs;
};

Result<Pairs> ReadPairs(const TableDeclaration& declared) {
  Pairs result;
  SCANCAL_ASSIGN_OR_RETURN(result.table, Table::Read(declared.format, DistanceColumns()));
  const Table& table = result.table;
  const auto index = [&](const std::string& ball) {
    const auto found = std::find(result.balls.begin(), result.balls.end(), ball) - result.balls.begin();
    if (found == std::ssize(result.balls)) result.balls.push_back(ball);
    return static_cast<int>(found);
  };
  for (size_t row = 0; row < table.rows(); ++row) {
    BallPair pair{index(table.Text("ball_a", row)), index(table.Text("ball_b", row)), table.Number("distance", row), 0,
                  row};
    if (table.Has("u")) pair.u = table.Number("u", row);
    if (std::isnan(pair.u)) pair.u = 0;
    if (pair.a == pair.b) return table.Wrong(row, "ball_b", "found the same ball twice, expected two");
    if (pair.distance <= 0) return table.Wrong(row, "distance", "expected a distance above 0");
    if (pair.u < 0) return table.Wrong(row, "u", "expected a standard uncertainty, not negative");
    result.pairs.push_back(pair);
  }
  return result;
}

// The pose as if it had seen that ball alone; no balls: it did not see it.
Model::View Only(const Model::View& view, int ball) {
  Model::View only = view;
  std::erase_if(only.balls, [&](const Model::SeenBall& seen) { return seen.sphere != ball; });
  return only;
}

// Of poses of one station; false: it did not see both balls.
bool FindPoses(const Station& station, const BallPair& pair, CheckLength* length) {
  const auto saw = [](int ball) {
    return [ball](const Model::View& view) {
      return std::any_of(view.balls.begin(), view.balls.end(), [&](const auto& seen) { return seen.sphere == ball; });
    };
  };
  const auto& views = station.views;
  auto first = std::find_if(views.begin(), views.end(), saw(pair.a));
  const auto last = std::find_if(views.rbegin(), views.rend(), saw(pair.b));
  if (first == views.end() || last == views.rend()) return false;
  if (&*first == &*last)  // another one may have seen a as well
    if (const auto other = std::find_if(first + 1, views.end(), saw(pair.a)); other != views.end()) first = other;
  length->first_pose = Only(*first, pair.a);
  length->second_pose = Only(*last, pair.b);
  return true;
}

// The distance in the frame of the scanner, where one pose saw both balls, over the true one; 1 where none did.
double RatioWithinAPose(const Station& station, const BallPair& pair) {
  for (const Model::View& view : station.views) {
    const Model::View a = Only(view, pair.a), b = Only(view, pair.b);
    if (!a.balls.empty() && !b.balls.empty()) return (a.balls[0].centre - b.balls[0].centre).norm() / pair.distance;
  }
  return 1;
}

}  // namespace

std::vector<TableColumn> DistanceColumns() {
  using enum Dimension;
  return {
      {"ball_a"}, {"ball_b"}, {"distance", Cells::kNumber, kLength}, {"u", Cells::kNumberOrNothing, kLength, false}};
}

Result<CheckLengths> ReadCheck(const CheckFiles& files, const std::filesystem::path& folder,
                               const std::vector<Link>& links, const std::vector<Coupling>& couplings,
                               double ball_diameter) {
  CheckLengths result;
  SCANCAL_ASSIGN_OR_RETURN(const Pairs pairs, ReadPairs(files.distances));
  SCANCAL_ASSIGN_OR_RETURN(Poses poses, ReadPoses(files.poses, links, couplings));
  SCANCAL_ASSIGN_OR_RETURN(Observations observations, ReadObservations(files.observations, folder, ball_diameter));
  SCANCAL_RETURN_IF_ERROR(AttachBalls(observations, pairs.balls, pairs.table.name(), 0, &poses));
  result.has_temperature = poses.table.Has("temperature");
  result.files = std::move(observations.files);
  result.warnings = std::move(observations.warnings);
  size_t from_one_pose = 0;
  for (const BallPair& pair : pairs.pairs) {
    const std::string name =
        pairs.balls[static_cast<size_t>(pair.a)] + " - " + pairs.balls[static_cast<size_t>(pair.b)];
    const size_t before = result.lengths.size();
    for (const Station& station : poses.stations) {
      CheckLength length{name + " at " + station.name, {}, {}, pair.distance, pair.u};
      if (!FindPoses(station, pair, &length)) continue;
      if (const double ratio = RatioWithinAPose(station, pair); std::abs(std::log(ratio)) > kMostOff)
        return pairs.table.Wrong(
            pair.row, "distance",
            fmt::format("the distance {} is {:.4g} times this one as the scanner saw it in a pose, expected nearly the "
                        "same; see units: length, the names of the columns and of the balls",
                        length.name, ratio));
      from_one_pose += length.first_pose.name == length.second_pose.name;
      result.lengths.push_back(std::move(length));
    }
    if (result.lengths.size() == before)
      return pairs.table.Wrong(
          pair.row, "ball_a",
          "no station of " + poses.table.name() + " saw both " + name + "; expected them in poses of one station");
  }
  if (from_one_pose > 0)
    result.warnings.push_back(Say(kLengthsOfOnePose, pairs.table.name(), from_one_pose, result.lengths.size()));
  return result;
}

}  // namespace scancal::robot_ball
