// What a dataset.yaml and its tables say of a robot's links and joints.
#pragma once
#include <span>
#include <string>
#include <vector>
#include "io/dataset.h"
#include "io/table.h"
#include "models/chain/chain.h"

namespace scancal {

// Reach of any robot, mm: outside of it the unit is another.
inline constexpr double kLeastReach_mm = 20, kLargestReach_mm = 20'000;

// robot: {links: [{theta: 0, d: 333, a: 0, alpha: -90, beta: 0}, ...]}, base to flange, in the data set's units; theta
// and beta are 0 where they are not given. None without `robot:`. Complains of units that no arm can have.
std::vector<Link> ReadLinks(YamlMap top, const Units& units);

// robot: {gravity: [0, 0, -1]}: its direction in the base, of any length; down along the base's z where it is not
// given.
Eigen::Vector3d ReadGravity(YamlMap top);

// parameters: {links: {estimate: 0, u_length: 0.5, u_angle: 0.1}}, in mm and rad.
struct LinkSetting {
  bool hold = false;                 // all of them; what is named singly stands
  double u_length = 0, u_angle = 0;  // of the prior of each that is estimated by default; 0: none
};
LinkSetting ReadLinkSetting(const Dataset& dataset);

// The parameters of a robot: its links as a whole, then each quantity that is named. links: how many; first_link: the
// index of theta_1; without_nominal: see SetDeclared.
Result<void> SetParameters(const Dataset& dataset, const LinkSetting& setting, size_t links, int first_link,
                           int without_nominal, std::span<Quantity> quantities);

// Noise that `influences:` declares: the quantities of that source are known (u), estimated, or none. every: what has
// it always ("ball"), which refuses none; else empty.
Result<void> SetNoise(const InfluenceSetting& setting, const Dataset& dataset, const std::string& every,
                      std::span<Quantity> quantities);

// What `influences:` says of something that all poses share: {estimate: 0, u: ...}, {consider: ...}, estimate, hold, or
// a standard uncertainty. Sets all quantities of that source.
Result<void> SetSystematic(const InfluenceSetting& setting, const Dataset& dataset, std::span<Quantity> quantities);

// The same for what the joints do, of one joint or of all: "gravity_2", "gravity". False: it is no such name. terms:
// those of DeclareJointTerms. known: their names are added, for a suggestion.
Result<bool> SetJointTerms(const InfluenceSetting& setting, const Dataset& dataset, std::span<Quantity> terms,
                           std::vector<std::string>* known);

// Joint angles in tables: columns q1 .. qn, and one too many, which CheckJoints refuses. remedy: see TableColumn.
std::vector<TableColumn> JointColumns(size_t joints, const std::string& remedy);

// Refuses more joints than there are links, angles beyond two turns, and angles that all lie within some degrees: they
// are of the other unit.
Result<void> CheckJoints(const Table& table, size_t joints);

std::vector<double> JointsOf(const Table& table, size_t row, size_t joints);  // rad

}  // namespace scancal
