// What the program asks of a scanner: the half of a model that knows tables and files.
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>
#include "io/dataset.h"
#include "io/json_file.h"
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
};

struct CompareChoice {
  bool brief = false;  // without what takes much longer than a calibration; the row's note says so
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
  // The published method and ours on the same data, one row each; the last row is the reference.
  virtual Result<Comparison> Compare(const CompareChoice& choice) const = 0;
  // The search's objective over its box, one line a node.
  virtual Result<void> WriteSurface(const std::filesystem::path& file) const = 0;
};

// One kind of scanner; models.h lists them.
struct ScannerKind {
  const char* name;  // `model:` in dataset.yaml
  Result<std::unique_ptr<Scanner>> (*load)(const Dataset& dataset);
  // From Scanner::Data(), without the scans: every digit of Calibrate() is the same. file: for messages.
  Result<std::unique_ptr<Scanner>> (*reload)(const Dataset& dataset, const Json& data, const std::string& file);
  // All points of the data set's scans in the frame of the calibration, which is of this model, streamed; returns their
  // number.
  Result<int64_t> (*transform)(const Dataset& dataset, const Calibration& calibration, PointCloudWriter* cloud);
  // Points as the scanner shows them, in the frame of the calibration with their uncertainty; distances: of each from
  // the one before.
  Result<Propagation> (*propagate)(const Calibration& calibration, const PointRequest& points, bool distances);
};

}  // namespace scancal
