// The joint angles in a robot's tables: columns q1 .. qn.
#pragma once
#include <string>
#include <vector>
#include "io/table.h"

namespace scancal {

std::string JointColumn(size_t joint);  // "q1" of joint 0

// Those of the joints, and one too many, which CheckJoints refuses.
std::vector<TableColumn> JointColumns(size_t joints);

// Refuses more joints than there are links, angles beyond two turns, and angles that all lie within some degrees: they
// are of the other unit.
Result<void> CheckJoints(const Table& table, size_t joints);

std::vector<double> JointsOf(const Table& table, size_t row, size_t joints);  // rad

}  // namespace scancal
