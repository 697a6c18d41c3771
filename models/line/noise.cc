#include "models/line/noise.h"
#include <algorithm>
#include <cmath>
#include "models/line/moments.h"

namespace scancal {
namespace {

constexpr double kStandardErrors = 2;
constexpr double kLeastLeft = 0.2;  // of what a line shows of C: below this the correction would be mostly noise

// Twice the integral from lag 0 to lag `last`: 1 + 2 sum of what follows, if f(0) = 1.
double TwiceIntegral(const std::vector<double>& f, size_t last) {
  double sum = 0;
  for (size_t k = 0; k < last; ++k) sum += (LagSums::Lag(k + 1) - LagSums::Lag(k)) * (f[k] + f[k + 1]);
  return sum;
}

std::vector<double> PerPair(const std::vector<double>& sums, const std::vector<double>& pairs) {
  std::vector<double> result(sums.size());
  for (size_t k = 0; k < sums.size(); ++k) result[k] = sums[k] / pairs[k];
  return result;
}

// a' R a - a' a, R_ij = phi^|i - j|.
double Excess(const std::vector<double>& a, double phi) {
  double sum = 0, before = 0;  // before: sum of phi^(i - j) a_j over j < i
  for (const double x : a) {
    sum += 2 * x * before;
    before = phi * (before + x);
  }
  return std::max(0.0, sum);
}

}  // namespace

double LagSums::Lag(size_t index) {
  if (index < 4) return static_cast<double>(index);
  return std::ldexp(index % 2 == 0 ? 4 : 6, static_cast<int>(index - 4) / 2);
}

void LagSums::Add(std::span<const double> residuals) {
  const double n = static_cast<double>(residuals.size());
  for (size_t k = 0; Lag(k) <= n / 2; ++k) {
    const double lag = Lag(k), m = n - lag;
    if (k == products.size())
      for (auto* sums : {&products, &pairs, &absorbed}) sums->push_back(0);
    const auto shift = static_cast<size_t>(lag);
    products[k] += SumOfProducts(residuals.data(), residuals.data() + shift, residuals.size() - shift);
    pairs[k] += m;
    absorbed[k] += m / n + (n > 1 ? m * (m * m - 1 - 3 * lag * lag) / (n * (n * n - 1)) : 0);
  }
}

LineCorrelation Correlate(const LagSums& sums) {
  LineCorrelation result;
  if (sums.products.size() < 2 || !(sums.products[0] > 0)) return result;
  const std::vector<double> shown = PerPair(sums.products, sums.pairs), lost = PerPair(sums.absorbed, sums.pairs);
  result.dies_out = false;
  for (size_t cut = 1; cut < shown.size() && !result.dies_out; ++cut) {
    const double left = 1 - TwiceIntegral(lost, cut);
    if (left < kLeastLeft) break;
    const double C = TwiceIntegral(shown, cut) / left;
    result.lags.clear();
    result.correlation.clear();
    for (size_t k = 0; k < shown.size(); ++k) {
      result.lags.push_back(LagSums::Lag(k));
      result.correlation.push_back((shown[k] + C * lost[k]) / (shown[0] + C * lost[0]));
    }
    result.length = TwiceIntegral(result.correlation, cut);
    std::vector<double> squares;
    for (const double rho : result.correlation) squares.push_back(rho * rho);
    const double standard_error = std::sqrt(TwiceIntegral(squares, cut) / sums.pairs[cut]);
    result.dies_out = result.correlation[cut] < kStandardErrors * standard_error;
  }
  return result;
}

void ResidualHistogram::Add(std::span<const double> residuals) {
  if (!(scale > 0)) return;
  const double bins_per_unit = kBins / (2 * kLimit) / scale;
  for (const double residual : residuals) {
    const double bin = std::floor((residual + kLimit * scale) * bins_per_unit);
    if (bin < 0) {
      ++below;
    } else if (bin >= kBins) {
      ++above;
    } else {
      ++counts[static_cast<size_t>(bin)];
    }
  }
}

LineNoise ExcessOfCorrelatedNoise(double length, double points, double spread) {
  const auto n = static_cast<size_t>(points);
  if (!(length > 1) || n < 2 || !(spread > 0)) return {};
  const double phi = (length - 1) / (length + 1);
  const double step = spread * std::sqrt(12 / (points * points - 1));  // of equally spaced points
  std::vector<double> mean(n, 1 / points), slope(n);
  for (size_t i = 0; i < n; ++i)
    slope[i] = (static_cast<double>(i) - (points - 1) / 2) * step / (points * spread * spread);
  return {std::sqrt(Excess(mean, phi)), std::sqrt(Excess(slope, phi))};
}

}  // namespace scancal
