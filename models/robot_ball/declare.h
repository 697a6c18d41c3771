// What a robot's dataset.yaml declares, and the tables that it names.
#pragma once
#include <filesystem>
#include <string>
#include <vector>
#include "io/dataset.h"
#include "io/result.h"
#include "models/chain/declare.h"
#include "models/robot_ball.h"
#include "solver/sentence.h"

namespace scancal::robot_ball {

inline constexpr char kTracker[] = "robot-tracker";

struct Declaration {
  Dataset dataset;
  Measurements data;
  std::vector<double> u_of_spheres;  // of each centre's coordinates, mm; 0: exactly known
  bool centres_have_u = false;       // the balls' noise was declared line by line
  LinkSetting links;
  Arm arm;
  bool held_out_stand = false;  // the poses held out are of the same stations: where calibration found the artifact
  std::string echo;             // how its tables are written and read, in words
  std::vector<std::filesystem::path> files;  // all that were read, dataset.yaml first
  std::vector<Sentence> warnings;            // worth knowing
};

// Takes every key of the data set and reads its tables. Errors name file, line and column, what was found and a remedy;
// what can be used but should be known is a warning. The order of lines does not matter but for the order of stations
// and poses in the result.
Result<Declaration> Declare(const Dataset& dataset);

// The same from tables that were read before, as calibration.json keeps them: `read` holds data, u_of_spheres,
// centres_have_u and warnings.
Result<Declaration> Redeclare(const Dataset& dataset, Declaration read);

// The model of those links and spheres, with roles, values, priors and influences as declared.
Result<Model> DeclareModel(const Declaration& declaration);

}  // namespace scancal::robot_ball
