// From the file of a scan to the placement of a plate: points as they are read, the profiles that stand for them
// exactly, and placements made of profiles, in which no point exists any more.
#pragma once
#include <Eigen/Core>
#include <array>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include "io/json.h"
#include "io/result.h"
#include "models/line/noise.h"
#include "models/turntable.h"
#include "models/turntable/declare.h"
#include "solver/calibrate.h"

namespace scancal::turntable {

struct RawProfile {
  double key = 0;             // value of the column `profile`; without it the running number
  double alpha = 0;           // rad, clockwise seen from +Z
  std::vector<double> y, z;   // mm
  std::vector<double> range;  // mm; a lidar's, else empty
  double time = 0;            // of the column `time`; without it the running number
  double temperature = 0;     // of the column `temperature`
};

void OrderAlongLine(RawProfile* profile);  // by z; points at one z keep their order

inline constexpr int kSegments = 8;

struct Profile {
  double alpha = 0;  // rad, clockwise seen from +Z
  double count = 0;
  // Of rows (1, z, y), for each eighth of the profile's extent in z that has points: where a smooth form of the plate
  // bends a profile, its mean is not enough.
  std::vector<ProfileFactor> segments;
  ProfileFactor factor;                 // of all points: the segments, merged
  std::optional<ProfileFactor> ranged;  // a lidar's: the same rows times the range at the profile's own line
  PureError pure_error;                 // of depth (of range) about the profile's own line
  double time = 0;                      // as logged, or the running number in the file
  double temperature = 0;               // as logged, else 0
};

// From what is kept to what follows from it: factor and pure error.
Profile MakeProfile(double alpha, double count, std::vector<ProfileFactor> segments,
                    const std::optional<ProfileFactor>& ranged);

// Compresses one profile's points, in any order; fastest in that of z. range: a lidar's, empty for a profiler.
Profile CompressProfile(double alpha, std::span<const double> y, std::span<const double> z,
                        std::span<const double> range);

// Of points of the profile, from its own least-squares line: along depth (a lidar's along the range), mm.
std::vector<double> ResidualsFromLine(const Profile& profile, std::span<const double> y, std::span<const double> z);

struct RawScan {
  std::string name;                  // of the target
  std::vector<RawProfile> profiles;  // in the order of their keys; of a large scan only those that Clean is to see next
  std::vector<Profile> compressed;   // after Clean
  double missing = 0;                // no return
  double off_line = 0;               // removed by Clean: off the line of their profile
  double copied = 0;                 // removed by DropCopies
  double lines = 0;                  // profiles that were read
  std::vector<Sentence> warnings;
  std::string dialect;                       // of its text, as it was found; empty: plain
  bool timed = false;                        // a column says the time
  double step = 0;                           // in which depth (range) is written, mm; after DropCopies
  std::optional<bool> turned_within_angles;  // whether profiles at one angle were taken while it turned
  // False of a large scan: its points are gone as soon as their profile is compressed. Then Clean is called for some
  // profiles after the others, and adds what is told from points.
  bool holds_points = true;
  std::optional<double> common_scale;  // of the first profiles that were cleaned
  struct Seen {
    std::array<double, 2> depths = {std::numeric_limits<double>::infinity(),
                                    -std::numeric_limits<double>::infinity()};  // from, to
    double largest = 0;                                                         // |coordinate|
    LagSums lag_sums;
    ResidualHistogram histogram;
  } seen;
};

// Reads the points that `keep` keeps, and cleans them. With a column `profile` its values group the points, in any
// order; without it a change of the angle starts a profile. Of more than kHeldPoints points of a profiler whose
// profiles come one after the other none is kept. progress: told the finished fraction.
inline constexpr size_t kHeldPoints = 1'000'000;
Result<RawScan> ReadScan(const ScanDeclaration& scan, const Senses& senses,
                         const std::function<void(double)>& progress);

// A value of depth (of the range, as it is) that stands in most profiles of a scan, apart from all others: what a
// sensor writes where it sees nothing, and nobody declared. A lidar with steps of 1 mm repeats itself, too, but then
// the steps beside a value are as full.
std::optional<double> RepeatedValue(const std::vector<RawProfile>& profiles);

// Profiles that were taken one after the other at one written angle, without a column that tells them apart: where the
// lines differ by more than their noise, the table has turned, and each is a profile by itself.
void SplitAtRoundedAngles(RawScan* scan);
void NoteRoundedAngles(RawScan* scan);  // adds the warning, once all is read

// Angles that wrap at 360 degrees, or run through many turns, as angles of one sweep, those of the scans near each
// other. A scan that is seen over more than half a turn is left as it is.
void Unwind(std::vector<RawScan>* scans);

// Leaves out profiles and points that are copies of others, of the same scan or another, and says so: they agree as
// closely as their digits tell, or to 2 % of their noise, in nine points of ten, and for independent readings of that
// noise and resolution the probability of it is below e^-40. Where readings scatter less than a step they repeat
// themselves, and nothing is a copy. A target of which less than a fifth is left goes as a whole. Where the points are
// gone only what is equal to 12 digits is a copy.
void DropCopies(std::vector<RawScan>* scans);

// One batch of a scan as points of the sensor: columns angle (rad, by the sense), y, z, and range for a lidar.
struct SensorColumns {
  std::vector<double> alpha, y, z, range;
};
void ToSensor(const Senses& senses, const ScanBatch& batch, SensorColumns* points);
// Which rows of the batch every interval of `keep` keeps; y and z may be derived from bearing and range.
Result<std::vector<char>> Kept(const ScanDeclaration& scan, const ScanBatch& batch, const SensorColumns& points);
Error HeightsWithoutSense(const ScanDeclaration& scan);  // gives_heights(), and no depth: is declared

// The profiles as the model sees them, with the columns of errors that move a profile's line.
std::vector<Model::View> Views(const std::vector<Profile>& profiles, Model::Residuals residuals);
// For planes through the pseudo-points of a known system.
std::vector<Model::View> PlaneViews(const std::vector<Profile>& profiles, const System& system);
Eigen::Vector3d PointOf(const System& system, const ProfileInTable<double>& in_table, const Model::View& profile,
                        Eigen::Index point);

// Errors that curve along a profile fill columns of the views, as the straight line that they look like there. What is
// left of them bends the profile; that moves no plane, and is lost in the noise of single points.
//
// `bend`: System::Shapes over the system's depths and heights.
void AddBend(const System& system, const std::vector<Profile>& profiles, std::vector<Model::View>* views);
// `form`: the modes of FormModesAt. The plate's square is the rectangle that bounds the points as they lie on the plane
// n . P = d: across the plate at right angles to the table's axis, and up. It starts from the placement's own points,
// so one plate in all placements has one form only if its edges are in view. Returns the sides, mm.
Eigen::Array2d AddForm(const std::vector<Profile>& profiles, const System& system, const Eigen::Vector3d& normal,
                       double distance, std::vector<Model::View>* views);

struct Placement;
// How far each profile of placement t has come in the kinds of drift (0 to 1: over its own sweep, over the measurement,
// exponentially over the measurement, over the range of logged temperatures), and which way and how fast it moved.
void AddMotion(const std::vector<Placement>& placements, size_t t, std::vector<Model::View>* views);
// Whether each scan goes there and back, or otherwise takes its angles at different times: then a drift over the sweep
// is no function of the angle, and the data tell it.
bool SweepsTellDrift(const std::vector<Placement>& placements);

struct Placement {
  std::string name;
  std::vector<Profile> profiles;
  double missing = 0;                       // no return
  std::map<std::string, double> set_aside;  // reason -> points
  double largest = 0;                       // |coordinate|, mm, over all kept points
  LagSums lag_sums;                         // of the residuals from each profile's own line, with three points or more
  ResidualHistogram histogram;              // of the same, by their pooled standard deviation
  std::vector<Sentence> warnings;           // of reading
  std::string dialect;                      // of the text that was read; empty: plain, or none was read
  bool timed = false;                       // the profiles' times were logged; else they are their numbers
  double Points() const;
  double Sweep() const;    // largest minus smallest angle, rad
  PureError Pure() const;  // of all profiles
  bool IsLidar() const { return !profiles.empty() && profiles.front().ranged.has_value(); }
};

PureError PureOf(const std::vector<Profile>& profiles);  // of all of them
PureError PureOf(const std::vector<Placement>& placements);

// The readings over which scans extend.
struct ScannedVolume {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::array<double, 2> alpha{kInfinity, -kInfinity}, y = alpha, z = alpha;  // from, to; rad, mm
  void Extend(double alpha, double y, double z);
  // "y = 300 mm (scanned: 40 to 120 mm)" of the first coordinate that lies outside by more than a hundredth of the
  // range; else empty.
  std::string Beyond(double alpha, double y, double z) const;
};
// A profile is taken to end where an evenly spaced line of the same mean and spread does: its points are gone.
ScannedVolume VolumeOf(const std::vector<Placement>& placements);

// Orders the points of each profile along z, removes what is off its own line, and compresses the rest.
void Clean(RawScan* scan);

// What is left of a clean scan without what is off the plane of most profiles, as `system` sees it: point by point, or
// where these are gone by segments.
struct PointsOnPlane {
  double off = 0;                           // points removed
  std::vector<const RawProfile*> profiles;  // of the scan, or of `changed`; none where the points are gone
  std::vector<Profile> compressed;          // each of them
  std::deque<RawProfile> changed;           // profiles that have lost points
};
PointsOnPlane SetAsideOffPlane(const RawScan& scan, const System& system);
Placement MakePlacement(const RawScan& scan, const PointsOnPlane& points);  // without lag_sums and histogram
void LookAtResiduals(const RawScan& scan, const PointsOnPlane& points, Placement* placement);  // adds them

// {"layout": what follows in plain words, "targets": [...], "sha256": of the text of segments, "segments": base64 of
// little-endian float64}: what a result is recomputed from, years later and without the points. Every digit is kept:
// the same placements come back, to the last bit.
Result<Json> PlacementsToJson(const std::vector<Placement>& placements);
// Refuses what is damaged, incomplete or no data of a turntable, in one sentence that names the file.
Result<std::vector<Placement>> PlacementsFromJson(const Json& data, const std::string& file);

}  // namespace scancal::turntable
