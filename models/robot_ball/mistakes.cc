// Which poses contradict the others, and which of the usual mistakes would explain it.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include "io/message.h"
#include "models/median.h"
#include "models/robot_ball/judge.h"
#include "models/robot_ball/start.h"
#include "solver/dense.h"
#include "solver/random.h"

namespace scancal::robot_ball {
namespace {

constexpr Message<size_t, size_t, std::string_view> kSetAside{
    "robot_ball.set_aside",
    "{} of {} poses contradict the others and are set aside: {}; check their joint angles and what was seen from them",
    "{} von {} Posen widersprechen den übrigen und sind ausgesondert: {}; ihre Gelenkwinkel und was aus ihnen gesehen "
    "wurde prüfen"};

constexpr Message<std::string_view, size_t, size_t, std::string_view> kCopies{
    "robot_ball.copies",
    "{}: {} of {} poses are copies of others (the same joints, and the same centres more nearly than noise allows); "
    "each "
    "counts once: {}",
    "{}: {} von {} Posen sind Kopien anderer (dieselben Gelenkwinkel, und dieselben Mittelpunkte genauer, als es das "
    "Rauschen zulässt); jede zählt einmal: {}"};

constexpr double kFarOff = 8;       // times the median of all poses: nominal links err alike, a wrong pose does not
constexpr double kLeastOff_mm = 5;  // below it the fit itself can tell
constexpr double kMany = 0.2;       // of the poses: more are no exception
constexpr int kTrials = 60;
constexpr double kDoubtful_mm = 3;  // of all poses: the nominal robot may err by as much
constexpr double kExplained = 0.2;  // what an explanation leaves of it
constexpr size_t kNamed = 5;

struct PoseAt {
  size_t station, view;
};

std::vector<PoseAt> AllPoses(const Measurements& data) {
  std::vector<PoseAt> poses;
  for (size_t t = 0; t < data.stations.size(); ++t)
    for (size_t v = 0; v < data.stations[t].views.size(); ++v) poses.push_back({t, v});
  return poses;
}

// How the poses of a robot with this hand-eye agree: mm, rms of a pose's balls from where the artifact then stands, as
// that pose of its station says with which most others agree; in the order of AllPoses. Station by station, so that no
// outlier moves anything.
class Agreement {
 public:
  explicit Agreement(const Measurements& data) : data_(data) {
    for (const Station& station : data.stations)
      for (const Model::View& view : station.views) {
        Eigen::Matrix3Xd world(3, std::ssize(view.balls)), tool = world;
        for (size_t b = 0; b < view.balls.size(); ++b) {
          world.col(static_cast<Eigen::Index>(b)) = data.InWorld(view.balls[b]);
          tool.col(static_cast<Eigen::Index>(b)) = data.OnTool(view.balls[b]);
        }
        constexpr double kLine = 1e-3;  // of the balls' extent
        const Eigen::VectorXd extent = SvdOf(world.colwise() - world.rowwise().mean().eval()).values;
        places_.push_back(world.cols() >= 3 && extent[1] > kLine * extent[0]);
        world_.push_back(world);
        tool_.push_back(tool);
        tool_from_world_.emplace_back(Eigen::Isometry3d::Identity());
        if (places_.back()) tool_from_world_.back() = MotionOnto(world, tool);
      }
  }

  std::vector<double> Off(const Kinematics& setup) const {
    std::vector<double> off;
    size_t first = 0;
    for (const Station& station : data_.stations) {
      const size_t n = station.views.size();
      std::vector<Eigen::Isometry3d> base_from_tool;
      for (const Model::View& view : station.views) base_from_tool.push_back(BaseFromScanner(data_, setup, view));
      std::vector<double> best(n, 0);
      double least = std::numeric_limits<double>::infinity();
      const size_t step = std::max<size_t>(1, n / kCandidates);
      for (size_t c = 0; c < n; c += step) {
        if (!places_[first + c]) continue;
        const Eigen::Isometry3d world = base_from_tool[c] * tool_from_world_[first + c];
        std::vector<double> each;
        for (size_t v = 0; v < n; ++v) {
          const Eigen::Matrix3Xd apart = world * world_[first + v] - base_from_tool[v] * tool_[first + v];
          each.push_back(std::sqrt(apart.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(1, apart.cols()))));
        }
        std::vector<double> others = each;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(c));
        if (const double median = Median(others); median < least) {
          least = median;
          best = each;
        }
      }
      off.insert(off.end(), best.begin(), best.end());
      first += n;
    }
    return off;
  }

 private:
  static constexpr size_t kCandidates = 12;  // of a station
  const Measurements& data_;
  std::vector<bool> places_;  // whether the pose places the artifact by itself
  std::vector<Eigen::Matrix3Xd> world_, tool_;
  std::vector<Eigen::Isometry3d> tool_from_world_;
};

// The poses of some stations, at least two of each.
Measurements SomeOf(const Measurements& data, Random* random) {
  constexpr size_t kPoses = 14, kOfAStation = 5;
  Measurements some = data;
  some.stations.clear();
  std::vector<size_t> stations(data.stations.size());
  for (size_t t = 0; t < stations.size(); ++t) stations[t] = t;
  const auto draw = [&](size_t n) {
    return std::min(n - 1, static_cast<size_t>(random->Uniform() * static_cast<double>(n)));
  };
  const size_t of_each = data.stations.size() == 1 ? kPoses : kOfAStation;
  size_t taken = 0;
  for (size_t left = stations.size(); left > 0 && taken < kPoses; --left) {
    std::swap(stations[draw(left)], stations[left - 1]);
    const Station& station = data.stations[stations[left - 1]];
    std::vector<Model::View> views = station.views;
    Station& part = some.stations.emplace_back(Station{station.name, {}, station.base_from_artifact});
    for (size_t n = views.size(); n > 0 && part.views.size() < of_each; --n) {
      std::swap(views[draw(n)], views[n - 1]);
      part.views.push_back(views[n - 1]);
    }
    taken += part.views.size();
  }
  return some;
}

struct Start {
  Kinematics setup;
  std::vector<double> off;
  double median = std::numeric_limits<double>::infinity();
};

bool IsFarOff(double off, double median) { return off > std::max(kLeastOff_mm, kFarOff * median); }

size_t FarOff(const Start& start) {
  return static_cast<size_t>(
      std::count_if(start.off.begin(), start.off.end(), [&](double off) { return IsFarOff(off, start.median); }));
}

// The hand-eye of all poses, or, where some of them contradict the others, of those few that most others agree with
// (random sample consensus: Fischler and Bolles 1981). No finite median: nothing was found.
Start Consensus(const Measurements& data, int trials) {
  const Agreement agreement(data);
  const auto from = [&](const Measurements& part) {
    Start start;
    const Result<Kinematics> setup = InitialHandEye(part);
    if (!setup.ok()) return start;
    start.setup = *setup;
    start.off = agreement.Off(*setup);
    start.median = Median(start.off);
    return start;
  };
  Start best = from(data);
  if (std::isfinite(best.median) && best.median < kDoubtful_mm && FarOff(best) == 0) return best;
  Random random(1, 0);
  for (int trial = 0; trial < trials; ++trial)
    if (Start start = from(SomeOf(data, &random)); start.median < best.median) best = std::move(start);
  return best;
}

// A mistake that people make: what the sentence says of it, and how the data would be without.
struct Mistake {
  std::string sentence;  // "... : {}" of what agrees
  std::function<void(Measurements*)> undo;
};

void ForEachView(Measurements* data, const std::function<void(Model::View&)>& change) {
  for (Station& station : data->stations)
    for (Model::View& view : station.views) change(view);
}

std::vector<Mistake> MistakesOfFlanges() {
  const auto of_pose = [](const std::string& sentence, const std::function<void(Eigen::Isometry3d&)>& change) {
    return Mistake{sentence, [change](Measurements* data) {
                     ForEachView(data, [&](Model::View& view) { change(view.base_from_flange); });
                   }};
  };
  const auto turned = [](Eigen::Isometry3d& pose, const Eigen::Quaterniond& turn) {
    pose.linear() = turn.normalized().toRotationMatrix();
  };
  return {
      of_pose("the quaternions are written with w first: name these columns qw, qx, qy, qz in place of qx, qy, qz, qw",
              [=](Eigen::Isometry3d& pose) {
                const Eigen::Quaterniond q(pose.linear());
                turned(pose, {q.x(), q.y(), q.z(), q.w()});
              }),
      of_pose("the quaternions are those of the inverse turn: change the sign of qx, qy, qz",
              [=](Eigen::Isometry3d& pose) { pose.linear().transposeInPlace(); }),
      of_pose("the poses are those of the base in the flange, x, y, z and qx, qy, qz, qw: invert them",
              [](Eigen::Isometry3d& pose) { pose = pose.inverse(); }),
      of_pose(
          "w comes first and the turn is inverse: name the columns qw, qx, qy, qz and change the sign of qx, qy, qz",
          [=](Eigen::Isometry3d& pose) {
            const Eigen::Quaterniond q(pose.linear());
            turned(pose, Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()).conjugate());
          }),
      of_pose("x, y, z of the flange are in m: see units: length, or name the columns x_m, y_m, z_m",
              [](Eigen::Isometry3d& pose) { pose.translation() *= 1000; }),
      of_pose("the frame is mirrored: change the sign of y, qx and qz", [](Eigen::Isometry3d& pose) {
        const Eigen::Matrix3d mirror = Eigen::Vector3d(1, -1, 1).asDiagonal();
        pose.linear() = mirror * pose.linear() * mirror;
        pose.translation().y() *= -1;
      })};
}

std::vector<Mistake> MistakesOfJoints(size_t joints) {
  std::vector<Mistake> mistakes;
  const auto name = [](size_t joint) { return "q" + std::to_string(joint + 1); };
  const auto of_joints = [&](const std::string& sentence, const std::function<void(std::vector<double>&)>& change) {
    mistakes.push_back({sentence, [change](Measurements* data) {
                          ForEachView(data, [&](Model::View& view) { change(view.joints); });
                        }});
  };
  for (size_t j = 1; j < joints; ++j)
    for (const int sign : {-1, 1})
      of_joints(
          fmt::format("{0} is coupled to {1}, as some controllers count: declare robot: {{coupled: {{{0}: {0} {2} "
                      "{1}}}}}",
                      name(j), name(j - 1), sign < 0 ? "-" : "+"),
          [=](std::vector<double>& q) { q[j] += sign * q[j - 1]; });
  for (size_t j = 0; j < joints; ++j)
    of_joints(fmt::format("{} turns the other way: change its sign", name(j)),
              [=](std::vector<double>& q) { q[j] = -q[j]; });
  for (size_t j = 1; j < joints; ++j)
    for (const int quarter : {1, -1, 2})
      of_joints(
          fmt::format("{} is zero elsewhere, {} deg away: see theta_{} of robot: links", name(j), 90 * quarter, j + 1),
          [=](std::vector<double>& q) { q[j] += quarter * std::numbers::pi / 2; });
  return mistakes;
}

// What was seen belongs to the pose before, or behind; poses in the order of the file.
std::vector<Mistake> MistakesOfOrder() {
  const auto shifted = [](int by) {
    return [by](Measurements* data) {
      std::vector<Model::View*> views;
      for (Station& station : data->stations)
        for (Model::View& view : station.views) views.push_back(&view);
      std::sort(views.begin(), views.end(), [](const auto* a, const auto* b) { return a->number < b->number; });
      std::vector<std::vector<Model::SeenBall>> balls;
      for (const Model::View* view : views) balls.push_back(view->balls);
      const auto n = std::ssize(views);
      for (std::ptrdiff_t v = 0; v < n; ++v) {
        const std::ptrdiff_t from = v + by;
        views[static_cast<size_t>(v)]->balls =
            from >= 0 && from < n ? balls[static_cast<size_t>(from)] : std::vector<Model::SeenBall>();
      }
      for (Station& station : data->stations)
        std::erase_if(station.views, [](const Model::View& view) { return view.balls.empty(); });
      std::erase_if(data->stations, [](const Station& station) { return station.views.empty(); });
    };
  };
  return {{"what was seen is one pose late: each pose goes with the observations of the next one", shifted(1)},
          {"what was seen is one pose early: each pose goes with the observations of the one before", shifted(-1)}};
}

// Those of the usual mistakes that explain it best, of equals the first: a wrist's joint that turns the other way is
// one that is zero half a turn away, but for its neighbours. Empty: none does.
std::string Explanation(const Measurements& data, double median) {
  std::vector<Mistake> mistakes = data.links.empty() ? MistakesOfFlanges() : MistakesOfJoints(data.links.size());
  for (Mistake& mistake : MistakesOfOrder()) mistakes.push_back(std::move(mistake));
  constexpr double kEqual = 0.99;
  std::string best;
  double least = kExplained * std::min(median, 1e6);
  for (const Mistake& mistake : mistakes) {
    Measurements without = data;
    mistake.undo(&without);
    const Start start = Consensus(without, kTrials / 4);
    if (!(start.median < (best.empty() ? 1 : kEqual) * least)) continue;
    least = start.median;
    best = mistake.sentence;
  }
  if (best.empty()) return best;
  const std::string before = std::isfinite(median) ? fmt::format("{:.3g} mm", median) : "no hand-eye fits at all";
  return fmt::format("{}? With this the poses agree to {:.3g} mm ({} as it is, median over the poses)", best, least,
                     before);
}

// "6-2 of station 6 (231 mm off; it fits station 4)".
std::string NameOf(const Measurements& data, const Start& start, const std::vector<PoseAt>& poses, size_t pose) {
  const Station& station = data.stations[poses[pose].station];
  std::string name = fmt::format("{} of station {} ({:.3g} mm off", station.views[poses[pose].view].name, station.name,
                                 start.off[pose]);
  const auto fits = [&](Measurements changed, size_t as) {
    return !IsFarOff(Agreement(changed).Off(start.setup)[as], start.median);
  };
  for (size_t other = 0; other < poses.size(); ++other) {
    if (other == pose || !IsFarOff(start.off[other], start.median)) continue;
    Measurements swapped = data;
    std::swap(swapped.stations[poses[pose].station].views[poses[pose].view].balls,
              swapped.stations[poses[other].station].views[poses[other].view].balls);
    if (fits(swapped, pose) && fits(swapped, other))
      return name + fmt::format("; are its observations and those of {} exchanged?)",
                                data.stations[poses[other].station].views[poses[other].view].name);
  }
  for (size_t t = 0; t < data.stations.size(); ++t) {
    if (t == poses[pose].station || data.stations[t].views.size() < 2) continue;
    Measurements moved = data;
    moved.stations[t].views.push_back(station.views[poses[pose].view]);
    size_t as = 0;
    for (size_t s = 0; s <= t; ++s) as += moved.stations[s].views.size();
    if (fits(std::move(moved), as - 1)) return name + fmt::format("; it fits station {})", data.stations[t].name);
  }
  return name + ")";
}

// How far two poses may be of one another as copies, and what repeated measurements of a centre scatter by.
struct Resolution {
  double step = 0, noise = 0;  // mm
};

Resolution ResolutionOf(const Measurements& data) {
  std::vector<double> numbers, errors;
  for (const Station& station : data.stations)
    for (const Model::View& view : station.views)
      for (size_t i = 0; i < view.balls.size(); ++i) {
        const Model::SeenBall& ball = view.balls[i];
        numbers.insert(numbers.end(), ball.centre.begin(), ball.centre.end());
        for (size_t j = 0; j < i; ++j) {
          const auto known = [&](const Model::SeenBall& of) {
            return data.spheres[static_cast<size_t>(of.sphere)].centre;
          };
          errors.push_back(
              std::abs((ball.centre - view.balls[j].centre).norm() - (known(ball) - known(view.balls[j])).norm()));
        }
      }
  std::sort(numbers.begin(), numbers.end());
  Resolution resolution{std::numeric_limits<double>::infinity(), 0};
  for (size_t k = 1; k < numbers.size(); ++k)
    if (const double gap = numbers[k] - numbers[k - 1]; gap > 1e-9) resolution.step = std::min(resolution.step, gap);
  resolution.noise = kMadToSigma * Median(errors) / std::numbers::sqrt2;  // a distance has the noise of two centres
  if (!(resolution.noise > 0)) resolution.noise = data.usual_ball_noise;
  return resolution;
}

bool IsSamePosture(const Model::View& a, const Model::View& b) {
  constexpr double kSame_rad = 2e-4, kSame_mm = 0.02;  // what rounding may have changed
  for (size_t j = 0; j < a.joints.size(); ++j)
    if (std::abs(a.joints[j] - b.joints[j]) > kSame_rad) return false;
  return (a.base_from_flange.translation() - b.base_from_flange.translation()).norm() <= kSame_mm &&
         (a.base_from_flange.linear() - b.base_from_flange.linear()).norm() <= kSame_rad;
}

// Whether independent measurements would be as near with a chance of less than 1e-6 among so many pairs.
bool IsCopy(const Model::View& a, const Model::View& b, const Resolution& resolution, double pairs) {
  constexpr double kChance = 1e-6;
  if (a.balls.size() != b.balls.size() || !IsSamePosture(a, b)) return false;
  double furthest = resolution.step / 2;
  for (const Model::SeenBall& ball : a.balls) {
    const auto same = std::find_if(b.balls.begin(), b.balls.end(),
                                   [&](const Model::SeenBall& other) { return other.sphere == ball.sphere; });
    if (same == b.balls.end()) return false;
    furthest = std::max(furthest, (ball.centre - same->centre).cwiseAbs().maxCoeff());
  }
  // |x - y| <= d of two normal numbers: d / (sigma sqrt(pi)) where d is small.
  const double each = std::min(1.0, furthest / (resolution.noise * std::sqrt(std::numbers::pi)));
  return std::log(pairs) + 3 * static_cast<double>(a.balls.size()) * std::log(each) < std::log(kChance);
}

void Remove(const std::set<std::pair<size_t, size_t>>& poses, Measurements* data) {
  for (size_t t = 0; t < data->stations.size(); ++t) {
    std::vector<Model::View>& views = data->stations[t].views;
    for (size_t v = views.size(); v-- > 0;)
      if (poses.contains({t, v})) views.erase(views.begin() + static_cast<std::ptrdiff_t>(v));
  }
  std::erase_if(data->stations, [](const Station& station) { return station.views.empty(); });
}

}  // namespace

void DropCopies(const std::string& where, Measurements* data, std::vector<Sentence>* warnings) {
  const std::vector<PoseAt> poses = AllPoses(*data);
  const auto view = [&](size_t k) -> const Model::View& {
    return data->stations[poses[k].station].views[poses[k].view];
  };
  const Resolution resolution = ResolutionOf(*data);
  if (!(resolution.noise > 0) || poses.size() < 2) return;
  std::vector<size_t> by_first;  // coordinate of what was seen first: copies are neighbours, but for rounding
  for (size_t k = 0; k < poses.size(); ++k)
    if (!view(k).balls.empty()) by_first.push_back(k);
  const auto key = [&](size_t k) {
    const auto& balls = view(k).balls;
    return std::min_element(balls.begin(), balls.end(),
                            [](const auto& a, const auto& b) { return a.sphere < b.sphere; })
        ->centre[0];
  };
  std::stable_sort(by_first.begin(), by_first.end(), [&](size_t a, size_t b) { return key(a) < key(b); });
  const double pairs = 0.5 * static_cast<double>(poses.size()) * static_cast<double>(poses.size() - 1);
  std::set<std::pair<size_t, size_t>> copies;
  std::map<int, std::string> named;  // by the copy's number
  for (size_t i = 0; i < by_first.size(); ++i)
    for (size_t j = i + 1; j < by_first.size() && key(by_first[j]) - key(by_first[i]) <= resolution.noise; ++j) {
      const auto [kept, copy] =
          std::minmax({by_first[i], by_first[j]}, [&](size_t a, size_t b) { return view(a).number < view(b).number; });
      if (copies.contains({poses[copy].station, poses[copy].view}) ||
          !IsCopy(view(kept), view(copy), resolution, pairs))
        continue;
      copies.insert({poses[copy].station, poses[copy].view});
      named[view(copy).number] = view(copy).name + " of " + view(kept).name;
    }
  if (copies.empty()) return;
  std::vector<std::string> names;
  for (const auto& [number, name] : named) names.push_back(name);
  warnings->push_back(Say(kCopies, where, copies.size(), poses.size(), Listed(names)));
  Remove(copies, data);
}

Result<Screened> Screen(const Measurements& data) {
  const Start start = Consensus(data, kTrials);
  const std::vector<PoseAt> poses = AllPoses(data);
  const size_t off = FarOff(start);
  const bool found =
      std::isfinite(start.median) && static_cast<double>(off) <= kMany * static_cast<double>(poses.size());
  if (!found || start.median > kDoubtful_mm)
    if (const std::string explanation = Explanation(data, start.median); !explanation.empty())
      return Error{"the poses contradict each other: " + explanation};
  if (!found) {
    SCANCAL_ASSIGN_OR_RETURN(const Kinematics all, InitialHandEye(data));  // says why not
    return Screened{data, all.flange_from_scanner, {}};
  }
  Screened result{data, start.setup.flange_from_scanner, {}};
  if (off == 0) return result;
  std::vector<size_t> far;
  for (size_t k = 0; k < poses.size(); ++k)
    if (IsFarOff(start.off[k], start.median)) far.push_back(k);
  std::stable_sort(far.begin(), far.end(), [&](size_t a, size_t b) { return start.off[a] > start.off[b]; });
  std::set<std::pair<size_t, size_t>> remove;
  std::string names;
  for (size_t k = 0; k < far.size(); ++k) {
    remove.insert({poses[far[k]].station, poses[far[k]].view});
    if (k < kNamed) names += (k ? ", " : "") + NameOf(data, start, poses, far[k]);
  }
  if (far.size() > kNamed) names += fmt::format(", and {} more", far.size() - kNamed);
  Remove(remove, &result.data);
  result.warnings.push_back(Say(kSetAside, far.size(), poses.size(), names));
  return result;
}

}  // namespace scancal::robot_ball
