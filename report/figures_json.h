// What calibration.json holds for the figures of the report.
#pragma once
#include <string>
#include <vector>
#include "io/json_file.h"
#include "solver/calibration.h"
#include "solver/results.h"

namespace scancal {

Json Number(double value);  // JSON has no infinity: what is not finite is null

// {"columns": [...], "units": [...], "rows": [[...], ...]}, and "names" of the rows if they have any.
Json ToJson(const NumberTable& table);
Json ToJson(const NumberTables& tables);  // by name

// {"targets": [{"name": ..., tables by name}]}; empty if no target has a scene.
Json SceneJson(const std::vector<TargetSummary>& targets);

// [{"method", "note", "cells": [{"column", "value", "u"}]}], without computing times: they are never the same.
Json ToJson(const Comparison& comparison);

}  // namespace scancal
