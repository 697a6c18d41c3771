// calibration.json: the result, kept for years. Stable keys; others may be added.
#pragma once
#include <filesystem>
#include <string>
#include "io/json_file.h"
#include "io/result.h"
#include "solver/calibration.h"
#include "solver/results.h"

namespace scancal {

inline constexpr int kFormatVersion = 1;

// The numbers of a MonteCarloParameter under their keys.
inline constexpr std::pair<const char*, double MonteCarloParameter::*> kMonteCarloNumbers[] = {
    {"mean", &MonteCarloParameter::mean},
    {"u", &MonteCarloParameter::deviation},
    {"low", &MonteCarloParameter::low},
    {"high", &MonteCarloParameter::high},
    {"gum_low", &MonteCarloParameter::gum_low},
    {"gum_high", &MonteCarloParameter::gum_high},
    {"tolerance", &MonteCarloParameter::tolerance}};

// What the file holds beside the calibration itself.
struct Enclosures {
  Json data = Json::object();  // Scanner::Data
  Json certificate = nullptr;  // of the data set; null: none
};

// The whole of calibration.json, and the only place that puts it together.
Json ToJson(const Calibration& calibration, const Enclosures& with = {});

// What only figures need and the file therefore leaves out, for its data give it again: "compare", "surface",
// "residuals", and "messages" as older versions kept them in the file. HoldsFigures: one of these.
Json FiguresToJson(const Calibration& calibration, const Comparison& comparison);
bool HoldsFigures(const Json& file);

// What a later command needs of it: model, status, parameters with roles and u, covariance, budget, volume, inputs,
// Monte Carlo. Old files lack some keys: those fields stay empty. null is not a number, or infinite for degrees of
// freedom. file: for messages.
Result<Calibration> CalibrationFromJson(const Json& json, const std::string& file);
Result<Calibration> ReadCalibration(const std::filesystem::path& file);

}  // namespace scancal
