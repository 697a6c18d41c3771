#include "models/selftest/known.h"
#include <glog/logging.h>
#include <cmath>
#include "io/number.h"

namespace scancal {
namespace {

constexpr double kDigitsOfDouble = 16;

double Agreement(double found, const Known& known) {
  const double error = std::abs(found - known.value) / std::abs(known.value);
  if (!std::isfinite(error)) return 0;
  return std::max(0.0, std::min(known.digits, -std::log10(error)));
}

}  // namespace

std::optional<Known> ParseKnown(std::string_view text) {
  const ParsedNumber number = ParseNumber(text);
  if (number.kind != NumberKind::kNumber || number.value == 0) return {};
  const std::string_view mantissa = text.substr(0, text.find_first_of("eE"));
  const ParsedNumber exponent = ParseNumber(text.substr(std::min(mantissa.size() + 1, text.size())));
  int digits = 0;
  for (const char c : mantissa) digits += (c >= '1' && c <= '9') || (c == '0' && digits > 0);
  const size_t point = mantissa.find('.');
  const auto decimals = static_cast<double>(point == std::string_view::npos ? 0 : mantissa.size() - point - 1);
  return Known{number.value, std::min<double>(digits, kDigitsOfDouble),
               std::log10(std::abs(number.value)) + decimals - exponent.value};
}

Digits Compare(const Eigen::VectorXd& found, const std::vector<std::string>& known, double required) {
  CHECK_EQ(found.size(), std::ssize(known));
  Digits worst{kAllDigits, 0};
  for (Eigen::Index k = 0; k < found.size(); ++k) {
    const std::optional<Known> number = ParseKnown(known[static_cast<size_t>(k)]);
    CHECK(number) << known[static_cast<size_t>(k)];
    const Digits digits{Agreement(found[k], *number), std::min(required, number->last_place)};
    if (digits.reached - digits.required < worst.reached - worst.required) worst = digits;
  }
  return worst;
}

}  // namespace scancal
