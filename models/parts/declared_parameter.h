// What `parameters:` of a dataset.yaml says of one quantity of a model.
#pragma once
#include <span>
#include <string>
#include <vector>
#include "io/dataset.h"
#include "solver/problem.h"

namespace scancal {

// data/dataset.yaml: and the sentence.
Error InFile(const Dataset& dataset, const std::string& sentence);

// One declared unit of such a quantity in mm, rad or 1.
double UnitFactor(Unit unit, const Units& units);

// Sets role, value and u of the quantity that is named; returns its index. quantities: those of system scope are the
// parameters, and the first so many have no nominal value: what holds or considers one of them gives it. others: names
// that may stand under `parameters:` besides, for a suggestion. Error: an unknown name; no value where one must be.
Result<int> SetDeclared(const ParameterSetting& setting, const Dataset& dataset, std::vector<std::string> others,
                        int without_nominal, std::span<Quantity> quantities);

}  // namespace scancal
