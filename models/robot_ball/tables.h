// The tables of a robot's data set: the artifact, the poses, what was seen from them, known lengths.
#pragma once
#include <filesystem>
#include <string>
#include <unordered_map>
#include <vector>
#include "io/table.h"
#include "models/chain/declare.h"
#include "models/robot_ball.h"
#include "solver/sentence.h"

namespace scancal::robot_ball {

struct Artifact {
  Table table;
  std::vector<Model::Sphere> spheres;
  std::vector<double> u;  // of each centre's coordinates, mm; nan: not said
};

// Columns ball, x, y, z[, u], in the artifact's own frame. Two balls of one name or in one place are refused.
std::vector<TableColumn> ArtifactColumns();
Result<Artifact> ReadArtifact(const TableDeclaration& declared);

struct Poses {
  struct Place {  // of a pose
    size_t station, view, row;
  };
  Table table;
  std::vector<Station> stations;  // in the order of the file, as are their views; none has balls yet
  std::unordered_map<std::string, Place> places;
  Model::View& View(const Place& place) { return stations[place.station].views[place.view]; }
};

// Columns station (of the only one, "world", where with_stations is not set), pose and q1 .. qn, one a link; without
// links x, y, z and those of a turn (Orientation): the flange in the base. Poses without names are numbered by their
// lines, from 1. Joint angles beyond two turns, or all of some degrees only, are of the other unit and refused, as is a
// pose that is named twice. A column temperature (degC) is View::warmer as it was logged.
std::vector<TableColumn> PoseColumns(size_t joints, bool with_stations);
Result<Poses> ReadPoses(const TableDeclaration& declared, const std::vector<Link>& links,
                        const std::vector<Coupling>& couplings, bool with_stations = true);

struct SeenCentre {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();      // in the scanner's frame, mm
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of it, mm^2; zero: not said
};

struct Observations {
  Table table;
  std::vector<SeenCentre> seen;              // one a row, or some of a row (Row)
  bool fitted = false;                       // to points
  std::vector<std::filesystem::path> files;  // of points
  std::vector<Sentence> warnings;
  std::string ball_column = "ball";
  std::vector<size_t> rows;        // of the table, one for each of `seen`; empty: they are one a row
  std::vector<std::string> balls;  // their names; empty: as the table says
  std::vector<std::string> poses;  // of each row
  size_t Row(size_t seen_one) const { return rows.empty() ? seen_one : rows[seen_one]; }
  const std::string& Pose(size_t seen_one) const { return poses[Row(seen_one)]; }
  const std::string& Ball(size_t seen_one) const {
    return balls.empty() ? table.Text(ball_column, seen_one) : balls[seen_one];
  }
};

// Columns pose, ball and x, y, z[, u], or file: points on that ball (columns x, y, z; its path from `folder`), through
// which a sphere is laid, of radius ball_diameter / 2 or, if that is 0, a free one. lengths in the declared unit.
std::vector<TableColumn> ObservationColumns();
Result<Observations> ReadObservations(const TableDeclaration& declared, const std::filesystem::path& folder,
                                      double ball_diameter);

// Reads the file of every row and sets centre and covariance. Refused: a sphere that the points do not determine, a
// declared diameter that they contradict, points of one laser line (a circle, which leaves the centre two-fold).
Result<void> FitBalls(const std::filesystem::path& folder, const ScanFormat& declared, double ball_diameter,
                      Observations* observations);

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

// What a tracker saw of points on the tool: columns pose, point, x, y, z[, u], or x, y, z and those of a turn
// (Orientation) of a 6-DoF target, in its own frame; in place of the latter stand three points of the target,
// SpheresOfTarget. Without a column pose each line is of the pose in the same line of its table.
std::vector<TableColumn> TrackedColumns();
Result<Observations> ReadTracked(const TableDeclaration& declared);
std::vector<Model::Sphere> SpheresOfTarget();  // its origin, and 100 mm along its x and its y
bool IsTarget(const std::vector<Model::Sphere>& spheres);

// Points of a tool that nobody measured, in a frame of their own: the shape that all poses saw on average (generalised
// Procrustes analysis: Gower 1975), and the standard uncertainty of a coordinate of it. The frame: the first point at
// the origin, the second on x, the third in the plane of x and y. names: of the points; the stations hold what was
// seen.
struct Shape {
  std::vector<Model::Sphere> spheres;
  double u = 0;
};
Result<Shape> ShapeOf(const std::vector<Station>& stations, const std::vector<std::string>& names);

struct CheckFiles {
  TableDeclaration poses, observations, distances;
};

struct CheckLengths {
  std::vector<CheckLength> lengths;
  bool has_temperature = false;              // of its poses, as logged
  std::vector<std::filesystem::path> files;  // of points on balls
  std::vector<Sentence> warnings;
};

// distances: columns ball_a, ball_b, distance[, u]; the others as in the calibration. Every station that saw both balls
// of a pair gives one length of it, as ten positions of a scale give ten errors: from the first pose that saw ball_a
// and the last other one that saw ball_b, for two poses test the robot and one tests the scanner alone; from one pose
// if it alone saw both, which is warned of. Balls of a check need not be those of the artifact: SeenBall::sphere counts
// the names of this table and means nothing outside. Refused: a pair that no station saw; lengths that are off by half
// and more, in the scanner's own frame: another unit, or other balls.
std::vector<TableColumn> DistanceColumns();
Result<CheckLengths> ReadCheck(const CheckFiles& files, const std::filesystem::path& folder,
                               const std::vector<Link>& links, const std::vector<Coupling>& couplings,
                               double ball_diameter);

}  // namespace scancal::robot_ball
