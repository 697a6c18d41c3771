// The tables of a robot's data set: the artifact, the poses, what was seen from them, known lengths.
#pragma once
#include <filesystem>
#include <string>
#include <unordered_map>
#include <vector>
#include "io/table.h"
#include "models/robot_ball.h"
#include "solver/sentence.h"

namespace scancal::robot_ball {

struct Artifact {
  Table table;
  std::vector<Model::Sphere> spheres;
  std::vector<double> u;  // of each centre's coordinates, mm; nan: not said
};

// Columns ball, x, y, z[, u], in the artifact's own frame. Two balls of one name or in one place are refused.
Result<Artifact> ReadArtifact(const std::filesystem::path& path, const Units& units);

struct Poses {
  struct Place {  // of a pose
    size_t station, view, row;
  };
  Table table;
  std::vector<Station> stations;  // in the order of the file, as are their views; none has balls yet
  std::unordered_map<std::string, Place> places;
  Model::View& View(const Place& place) { return stations[place.station].views[place.view]; }
};

// Columns station, pose and q1 .. qn, one a link; without links x, y, z, qx, qy, qz, qw: the flange in the base. Joint
// angles beyond two turns, or all of some degrees only, are of the other unit and refused, as are quaternions that are
// not normalised and a pose that is named twice.
Result<Poses> ReadPoses(const std::filesystem::path& path, const std::vector<Link>& links, const Units& units);

struct SeenCentre {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();      // in the scanner's frame, mm
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of it, mm^2; zero: not said
};

struct Observations {
  Table table;
  std::vector<SeenCentre> seen;              // one a row
  bool fitted = false;                       // to points
  std::vector<std::filesystem::path> files;  // of points
  std::vector<Sentence> warnings;
  const std::string& Pose(size_t row) const { return table.Text("pose", row); }
  const std::string& Ball(size_t row) const { return table.Text("ball", row); }
};

// Columns pose, ball and x, y, z[, u], or file: points on that ball (columns x, y, z; its path from `folder`), through
// which a sphere is laid, of radius ball_diameter / 2 or, if that is 0, a free one. lengths in the declared unit.
Result<Observations> ReadObservations(const std::filesystem::path& path, const std::filesystem::path& folder,
                                      const Units& units, double ball_diameter);

// What SeenBall::spread is relative to, mm: what was declared (0: nothing) or else the median of what is known of the
// centres themselves; 0 if neither.
double UsualNoise(const Observations& observations, double declared);

// Gives every view its balls, in the order of the lines; SeenBall::sphere is the place in `balls`. Refused: a pose that
// is not in the table, a ball that is not among `balls` (those of `where`), a ball twice in a pose. Of centres fitted
// to points only the shape and relative size of the covariance counts where a noise is declared: neighbouring points
// err alike, which the fit does not know.
Result<void> AttachBalls(const Observations& observations, const std::vector<std::string>& balls,
                         const std::string& where, double declared_noise, Poses* poses);

// Moves the stations out of the table, without the poses that saw no ball, which are warned of, and without stations
// that have no other.
std::vector<Station> TakeSeenStations(Poses* poses, std::vector<Sentence>* warnings);

struct CheckFiles {
  std::filesystem::path poses, observations, distances;
};

struct CheckLengths {
  std::vector<CheckLength> lengths;
  std::vector<std::filesystem::path> files;  // of points on balls
  std::vector<Sentence> warnings;
};

// distances: columns ball_a, ball_b, distance[, u]; the others as in the calibration. Every station that saw both balls
// of a pair gives one length of it, as ten positions of a scale give ten errors: from the first pose that saw ball_a
// and the last other one that saw ball_b, for two poses test the robot and one tests the scanner alone; from one pose
// if it alone saw both, which is warned of. Balls of a check need not be those of the artifact: SeenBall::sphere counts
// the names of this table and means nothing outside. Refused: a pair that no station saw; lengths that are off by half
// and more, in the scanner's own frame: another unit, or other balls.
Result<CheckLengths> ReadCheck(const CheckFiles& paths, const std::filesystem::path& folder,
                               const std::vector<Link>& links, const Units& units, double ball_diameter);

}  // namespace scancal::robot_ball
