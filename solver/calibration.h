// The result as a plain value. Lengths mm, angles rad, whatever the input used.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>
#include "solver/problem.h"
#include "solver/sentence.h"

namespace scancal {

// As a Calibration keeps it.
inline std::vector<double> Plain(const Eigen::VectorXd& x) { return {x.data(), x.data() + x.size()}; }

// Numbers for a figure: a row each, in the units of the columns; nan where there is none.
struct NumberTable {
  std::vector<std::string> columns;
  std::vector<Unit> units;
  std::vector<std::vector<double>> rows;
  std::vector<std::string> names;  // of the rows; empty: they have none
};
using NumberTables = std::map<std::string, NumberTable>;

struct Parameter {
  std::string name;
  Unit unit = Unit::kMm;
  Role role = Role::kHold;
  std::string source;  // its line in the budget; several parameters may share one
  double value = 0;
  std::optional<double> nominal;  // what it is added to, where it is the error of a known number
  double prior = 0, prior_u = 0;  // of an estimated one: mean and standard uncertainty; prior_u = 0: none
  // By what an estimated one is known: "data", or "prior" where the prior brings more than half of the information;
  // "held" or "considered" else.
  std::string determined;
  // Standard uncertainties; 0 for what is held. u is the headline (HeadlineOf).
  double u = 0, u_naive = 0, u_clustered = 0, u_jackknife = 0, u_bootstrap = 0;
  double dof = 0, k = 0, U = 0;  // U = k u, coverage kCoverage (solver/uncertainty/gum.h), as of every interval
};

// Residuals from a line of each view's own, in the order along the view, pooled over the views of a target.
struct ViewResiduals {
  std::vector<double> lags, correlation;  // of residuals so many points apart; empty: not known
  double correlation_length = 0;          // 1 + 2 sum of the correlation over all lags >= 1: 1 is white; 0: not known
  bool dies_out = true;                   // false: no end of the correlation was seen: the length is a lower bound
  double sigma = 0;                       // of the residuals, by degrees of freedom; mm
  double histogram_limit = 0;             // of residual / sigma, to either side
  std::vector<double> histogram;          // counts in bins of equal width
  double below = 0, above = 0;            // counts beyond the limits
};

struct TargetSummary {
  std::string name;
  double points = 0;                                    // used
  double missing = 0;                                   // no return
  std::map<std::string, double> set_aside;              // reason -> points
  std::map<std::string, std::vector<double>> geometry;  // as the model describes it: "normal", "distance"
  double rms = 0;                                       // of the fit's own residual, mm
  ViewResiduals residuals;
  NumberTables residual_tables;  // residuals where they were measured
  NumberTables scene;            // where the target and the scanner were
};

struct GridMinimum {
  std::vector<std::string> names;  // of the search parameters
  std::vector<double> at;          // where the minimum lies
  double S = 0;
  double step = 0;
  double nodes = 0;
};

struct BudgetLine {
  Sentence source;
  char type = 'A';  // A: from the data; B: declared
  Unit unit = Unit::kOne;
  double u = 0;                      // of the source
  std::vector<double> sensitivity;   // per estimated parameter
  std::vector<double> contribution;  // u per estimated parameter
  std::vector<double> share;         // of the parameter's variance
  double dof = 0;                    // infinite for what was declared
  bool random = false;               // noise: anew in every view or point
};

// What the result depends on, as declared or found: all quantities that share a source. Parameters that are estimated,
// and what only a target has for itself, are not among them.
struct Influence {
  std::string source;
  Unit unit = Unit::kOne;
  Scope scope = Scope::kSystem;
  Role role = Role::kHold;  // estimate: its variance, from the residuals
  double u = 0;             // rms over the quantities
};

// Known lengths that took no part in the calibration: measured minus known, mm.
struct LengthCheck {
  std::vector<Sentence> names;
  std::vector<double> before, after;  // as the nominal instrument shows them, and the calibrated one
  std::vector<double> u;              // of the known lengths; 0: not known. Empty: of none
};

struct ErrorSize {  // of absolute values; 0 of none
  double max = 0, mean = 0;
};
inline ErrorSize SizeOfErrors(const std::vector<double>& errors) {
  ErrorSize size;
  for (const double error : errors) {
    size.max = std::max(size.max, std::abs(error));
    size.mean += std::abs(error) / static_cast<double>(errors.size());
  }
  return size;
}

struct LackOfFit {  // of everything within views against everything between them: noise that is not white shows, too
  double pure_error_sigma = 0;              // mm
  double F = 0, dof1 = 0, dof2 = 0, p = 1;  // dof1 = 0: not computed
};

// A source of system or target scope that was not estimated, tested for what the residuals say of it (TestMisfits).
struct MisfitTest {
  std::string source;
  bool considered = false;  // with a u; else held
  Unit unit = Unit::kOne;
  double size = 0;                   // what a fit would give it; of several instances the rms that is not explained
  double F = 0, dof1 = 0, dof2 = 0;  // of the score test
  double p = 1;                      // for this source, among all that were tested
  std::vector<double> moves;         // per estimated parameter: by how much a misfit of that size moves it
};

struct JointRegion {  // all estimated parameters together
  double k = 0, dof = 0;
};

struct MonteCarloParameter {  // JCGM 101, of one estimated parameter
  std::string name;
  double mean = 0, deviation = 0;    // of the trials
  double low = 0, high = 0;          // probabilistically symmetric interval
  double gum_low = 0, gum_high = 0;  // value - U, value + U
  double tolerance = 0;              // by which the ends may differ, 7.9.2
  std::string verdict;               // on value +- U: PASS, FAIL or UNDECIDED
  std::vector<double> edges;         // of the bins of a histogram, one more than counts
  std::vector<double> counts;
};

struct MonteCarloSummary {
  double trials = 0;  // that were drawn; 0: none
  double failed = 0;  // of them did not settle, and are left out
  uint64_t seed = 1;
  int digits = 1;      // of u that the verdicts are about
  bool stable = true;  // at two digits: the adaptive procedure of 7.9 ended by itself
  std::vector<MonteCarloParameter> parameters;
};

struct HashedFile {
  std::string file, sha256;
};

struct Calibration {
  std::string model, name, residual;
  bool equal_weights = false;          // in place of weights from the variances
  std::vector<Sentence> warnings;      // worth knowing
  std::vector<Sentence> unreliable;    // why not to rely on it; none: status ok
  std::vector<Sentence> notes;         // what the data cannot show, and what was supposed: no doubt of this result
  std::vector<Parameter> parameters;   // every system quantity of role estimate or consider, and the model's main ones
  std::vector<std::string> estimated;  // the order of the covariance
  Eigen::MatrixXd covariance;          // of the headline
  JointRegion joint;
  GridMinimum grid;
  std::vector<TargetSummary> targets;
  double sigma = 0;  // rms residual by degrees of freedom, mm
  LackOfFit lack_of_fit;
  std::vector<MisfitTest> misfits;  // of a weighted fit
  double neighbours = 0;            // correlation of the residuals of neighbouring views
  double neighbour_noise = 0;       // of what is random in them, where it was estimated and is in u
  double noise_dof = 0;             // of a weighted fit: of what is known of the noise; not written
  double condition = 0;
  std::map<std::string, double> weakest;  // components of the least determined direction
  std::vector<BudgetLine> budget;
  std::vector<Influence> influences;
  std::vector<std::vector<double>> jackknife;  // per target: the estimated parameters without it
  MonteCarloSummary monte_carlo;
  // Points on a grid of readings that spans what was scanned, with the expanded uncertainties that the
  // calibration gives them. Columns: the numbers of a reading, "X", "Y", "Z", then U along these and in the direction
  // that is known least.
  NumberTable volume;
  NumberTables surface;                           // of the search's objective, around its minimum
  std::map<std::string, Eigen::Matrix4d> frames;  // rigid motions of the model, by name, mm
  LengthCheck check;
  int iterations = 0;
  bool converged = false;
  double seconds = 0;
  std::vector<HashedFile> inputs;
  std::string command, version;

  bool ok() const { return unreliable.empty(); }
  const Parameter* Find(const std::string& parameter) const {
    for (const Parameter& each : parameters)
      if (each.name == parameter) return &each;
    return nullptr;
  }
};

}  // namespace scancal
