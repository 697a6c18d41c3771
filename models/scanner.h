// What the program asks of a scanner, the half of a model that knows tables and files; and what all scanners do alike.
#pragma once
#include <Eigen/Core>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>
#include "io/dataset.h"
#include "io/json.h"
#include "io/points.h"
#include "io/result.h"
#include "solver/calibration.h"
#include "solver/results.h"
#include "solver/uncertainty/resampling.h"

namespace scancal {

struct RefineChoice {
  std::string residual;        // a model's name for one of its residuals; empty: the headline
  bool equal_weights = false;  // in place of weights from the estimated variances
  int max_iterations = 100;
  MonteCarloChoice monte_carlo{};
  bool figures = true;  // tables that only a figure needs, where they are large
};

struct CompareChoice {
  std::vector<double> steps = {1, 0.1};  // of a published search, mm
  bool brief = false;                    // without what takes much longer than a calibration; the row's note says so
};

// A scanner with its data loaded and compressed.
class Scanner {
 public:
  virtual ~Scanner() = default;
  // What was declared and read, in one plain sentence: what a reader could have got wrong.
  virtual std::string Describe() const = 0;
  virtual const Dataset& dataset() const = 0;
  // Every file that was read, dataset.yaml first.
  virtual std::vector<std::filesystem::path> Files() const = 0;
  // For calibration.json: the compressed data, and under "dataset" the text of dataset.yaml. ScannerKind::reload makes
  // the same scanner of it.
  virtual Result<Json> Data() const = 0;
  // The published search, then the joint refinement. An Error names a quantity that the data do not determine; doubts
  // about a computed result are fields of the Calibration.
  virtual Result<Calibration> Calibrate(const RefineChoice& choice) const = 0;
  // Optional: the published method and ours on the same data, one row each; the last row is the reference.
  virtual Result<Comparison> Compare(const CompareChoice& choice) const;
  // Optional: the search's objective over its box, one line a node.
  virtual Result<void> WriteSurface(const std::filesystem::path& file) const;
};

// One kind of scanner; models.h lists them.
struct ScannerKind {
  const char* name;  // `model:` in dataset.yaml
  Result<std::unique_ptr<Scanner>> (*load)(const Dataset& dataset);
  // From Scanner::Data(), without the scans: every digit of Calibrate() is the same. file: for messages.
  Result<std::unique_ptr<Scanner>> (*reload)(const Dataset& dataset, const Json& data, const std::string& file);
  // All points of the data set's scans in the frame of the calibration, which is of this model, streamed; returns their
  // number. transforms_with_u: gives what the cloud wants beside them.
  Result<int64_t> (*transform)(const Dataset& dataset, const Calibration& calibration, PointCloudWriter* cloud);
  // Optional: points as the scanner shows them, in the frame of the calibration with their uncertainty; distances: of
  // each from the one before.
  Result<Propagation> (*propagate)(const Calibration& calibration, const PointRequest& points,
                                   bool distances) = nullptr;
  bool transforms_with_u = false;
  // Optional: features of an artifact that took no part, as a data set of this model declares and has scanned them.
  Result<Verification> (*verify)(const Dataset& dataset, const Calibration& calibration) = nullptr;

  // An Error where there is none.
  Result<Propagation> Propagate(const Calibration& calibration, const PointRequest& points, bool distances) const;
};

// As Scanner::Data() keeps a sentence: {"id", "en", "de"}, or its English alone; nothing of what is neither.
Json ToJson(const Sentence& sentence);
std::optional<Sentence> SentenceFromJson(const Json& json);

// "data/dataset.yaml: " and the sentence.
Error InFile(const Dataset& dataset, const std::string& sentence);

// One declared unit of such a quantity in mm, rad or 1.
double UnitFactor(Unit unit, const Units& units);

// That a standard uncertainty (mm, rad, 1) is one that a scanner may have: below 20 m, a turn, and 1. place: of the
// key.
Result<void> CheckSize(const Dataset& dataset, const std::string& place, Unit unit, double u);

// What `parameters:` says of one quantity: sets role, value and u of the one that is named; returns its index.
// quantities: those of system scope are the parameters, and the first so many have no nominal value: what holds or
// considers one of them gives it. others: names that may stand there besides, for a suggestion. Error: an unknown name;
// no value where one must be.
Result<int> SetDeclared(const ParameterSetting& setting, const Dataset& dataset, std::vector<std::string> others,
                        int without_nominal, std::span<Quantity> quantities);

// How Describe begins: "NAME: KIND, lengths in mm, angles in deg". NAME: the data set's, or its folder's.
std::string Opening(const Dataset& dataset, const std::string& kind);

// For a model with one residual of this name, which "depth", the program's default, means as well.
Result<void> CheckOnlyResidual(const RefineChoice& choice, const std::string& name);
// An Error where Monte Carlo is asked of a fit with equal weights.
Result<void> CheckMonteCarlo(const RefineChoice& choice, bool weighted);

// What a model says of data that leave a quantity open.
struct UndeterminedWords {
  const char* target;     // what it calls one: "station"
  const char* of_target;  // "its plane is not determined; it needs profiles at two angles or more"
  const char* by;         // "these placements"
};
// An Error that names targets whose own quantities are not determined, or else quantities of the system.
Result<void> CheckDetermined(const Observability& seen, const UndeterminedWords& words);

class Stopwatch {  // runs from its construction on
 public:
  double Seconds() const;

 private:
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
};

// What a model has computed once it comes to the end of Calibrate.
struct Refined {
  const Solution& solution;
  std::string residual;                 // a name of it
  double seconds = 0;                   // of the refinement
  PureError pure_error = {};            // what repeats within a view
  std::vector<Sentence> warnings = {};  // of the declaration and of what was read: they come first
};

// What every scanner does then: Summarize, bootstrap and Monte Carlo with a progress bar, names. The model adds what
// only it can say.
Calibration Conclude(const Dataset& dataset, const Refined& refined, const MonteCarloChoice& monte_carlo);

// Tables of a result, as far as scanners share them; mm, rad.
NumberTable TableOf(const std::vector<std::pair<std::string, Unit>>& columns);  // without rows
NumberTable PointTable();                                                       // X, Y, Z
void AddPoint(const Eigen::Vector3d& p, NumberTable* points);

NumberTable SightTable();  // where the scanner was and the middle of what it saw: from_X .. from_Z, to_X .. to_Z
void AddSight(const Eigen::Vector3d& from, const Eigen::Vector3d& to, NumberTable* sights);

}  // namespace scancal
