#include "solver/uncertainty/validation.h"
#include <glog/logging.h>
#include <algorithm>
#include <cmath>
#include <limits>

namespace scancal {
namespace {

constexpr double kCoverage = 0.95;
constexpr double kStandardErrors = 2;
constexpr int64_t kBlock = 10'000;  // at least 100 / (1 - kCoverage)
constexpr double kShareOfTolerance = 1 / 5.0;

double Mean(std::span<const double> x) { return Eigen::Map<const Eigen::VectorXd>(x.data(), std::ssize(x)).mean(); }

double Deviation(std::span<const double> x) {
  const Eigen::Map<const Eigen::VectorXd> all(x.data(), std::ssize(x));
  return (all.array() - all.mean()).matrix().norm() / std::sqrt(static_cast<double>(x.size()) - 1);
}

struct Range {
  double low, high;
};

// The ends of the interval, and where each lies within its standard errors. Ranks are counted from 1.
struct SymmetricInterval {
  explicit SymmetricInterval(std::span<const double> trials) : sorted(trials.begin(), trials.end()) {
    std::sort(sorted.begin(), sorted.end());
    const double m = static_cast<double>(sorted.size());
    const double q = std::floor(kCoverage * m + 0.5);
    rank_low = std::floor((m - q + 1) / 2);  // 7.7.2: (m - q) / 2 if that is whole
    rank_high = rank_low + q;
    rank_error = kStandardErrors * std::sqrt(m * (1 - kCoverage) / 2 * (1 + kCoverage) / 2);
  }
  double At(double rank) const {
    if (rank < 1) return -std::numeric_limits<double>::infinity();
    if (rank > static_cast<double>(sorted.size())) return std::numeric_limits<double>::infinity();
    return sorted[static_cast<size_t>(rank) - 1];
  }
  double Low() const { return At(rank_low); }
  double High() const { return At(rank_high); }
  Range Around(double rank) const { return {At(std::floor(rank - rank_error)), At(std::ceil(rank + rank_error))}; }

  std::vector<double> sorted;
  double rank_low, rank_high, rank_error;
};

// |end - x| <= tolerance for every x in the range, for none, or for some.
Verdict Judge(double end, const Range& range, double tolerance) {
  const double farthest = std::max(std::abs(end - range.low), std::abs(end - range.high));
  const double nearest = std::max({range.low - end, end - range.high, 0.0});
  return farthest <= tolerance ? Verdict::kPass : nearest > tolerance ? Verdict::kFail : Verdict::kUndecided;
}

// Mean, deviation and ends of each block, one column a block; their averages over blocks are what 7.9.4 watches.
bool IsStable(const Eigen::Ref<const Eigen::MatrixXd>& of_blocks, double tolerance) {
  const double blocks = static_cast<double>(of_blocks.cols());
  if (blocks < 2) return false;
  const Eigen::ArrayXd squares = (of_blocks.colwise() - of_blocks.rowwise().mean()).rowwise().squaredNorm();
  return (2 * (squares / (blocks * (blocks - 1))).sqrt() < tolerance).all();
}

}  // namespace

const char* Name(Verdict verdict) {
  return verdict == Verdict::kPass ? "PASS" : verdict == Verdict::kFail ? "FAIL" : "UNDECIDED";
}

double NumericalTolerance(double u, int digits) {
  if (!(u > 0) || !std::isfinite(u)) return 0;
  double last = std::floor(std::log10(u)) - (digits - 1);
  if (std::round(u / std::pow(10, last)) >= std::pow(10, digits)) ++last;  // 0.96 to one digit is 1
  return 0.5 * std::pow(10, last);
}

Validation Validate(std::span<const double> trials, const GumInterval& gum, int digits) {
  CHECK_GE(trials.size(), 40) << "fewer have no 95 % interval";
  const SymmetricInterval interval(trials);
  Validation result{Mean(trials), Deviation(trials), interval.Low(), interval.High(), 0, 0, 0, Verdict::kUndecided};
  result.d_low = std::abs(gum.value - gum.U - result.low);
  result.d_high = std::abs(gum.value + gum.U - result.high);
  result.tolerance = NumericalTolerance(gum.u, digits);
  if (result.tolerance == 0) return result;
  const Verdict low = Judge(gum.value - gum.U, interval.Around(interval.rank_low), result.tolerance);
  const Verdict high = Judge(gum.value + gum.U, interval.Around(interval.rank_high), result.tolerance);
  if (low == Verdict::kFail || high == Verdict::kFail) result.verdict = Verdict::kFail;
  if (low == Verdict::kPass && high == Verdict::kPass) result.verdict = Verdict::kPass;
  return result;
}

AdaptiveSample SampleUntilStable(const std::function<Eigen::MatrixXd(int64_t first, int64_t trials)>& sample,
                                 std::span<const GumInterval> gum, int digits, int64_t most) {
  std::vector<Eigen::MatrixXd> blocks, watched(gum.size());
  AdaptiveSample result;
  Eigen::Index rows = 0;
  for (int64_t done = 0; done < most && !result.stable; done += kBlock) {
    const Eigen::MatrixXd& block = blocks.emplace_back(sample(done, std::min(kBlock, most - done)));
    rows += block.rows();
    if (block.rows() < kBlock / 2) break;  // the rest, or most did not settle
    result.stable = true;
    for (size_t k = 0; k < gum.size(); ++k) {
      const std::span<const double> column(block.col(static_cast<Eigen::Index>(k)).data(), block.rows());
      const SymmetricInterval interval(column);
      watched[k].conservativeResize(4, watched[k].cols() + 1);
      watched[k].rightCols(1) << Mean(column), Deviation(column), interval.Low(), interval.High();
      result.stable &= IsStable(watched[k], kShareOfTolerance * NumericalTolerance(gum[k].u, digits));
    }
  }
  result.trials.resize(rows, std::ssize(gum));
  for (Eigen::Index to = 0; const Eigen::MatrixXd& block : blocks) {
    result.trials.middleRows(to, block.rows()) = block;
    to += block.rows();
  }
  return result;
}

}  // namespace scancal
