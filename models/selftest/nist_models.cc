#include "models/selftest/nist_models.h"
#include <numbers>

namespace scancal {
namespace {

// As printed in the files, with b1 = b[0]: any T of b, the predictors x are double.

constexpr auto kSaturation = [](auto b, auto x) { return b[0] * (1.0 - exp(-b[1] * x[0])); };

constexpr auto kChwirut = [](auto b, auto x) { return exp(-b[0] * x[0]) / (b[1] + b[2] * x[0]); };

constexpr auto kCubicByCubic = [](auto b, auto x) {
  return (b[0] + x[0] * (b[1] + x[0] * (b[2] + x[0] * b[3]))) / (1.0 + x[0] * (b[4] + x[0] * (b[5] + x[0] * b[6])));
};

constexpr auto kLanczos = [](auto b, auto x) {
  return b[0] * exp(-b[1] * x[0]) + b[2] * exp(-b[3] * x[0]) + b[4] * exp(-b[5] * x[0]);
};

constexpr auto kGauss = [](auto b, auto x) {
  const auto s = (x[0] - b[3]) / b[4], t = (x[0] - b[6]) / b[7];
  return b[0] * exp(-b[1] * x[0]) + b[2] * exp(-s * s) + b[5] * exp(-t * t);
};

constexpr auto kEnso = [](auto b, auto x) {
  const double turn = 2 * std::numbers::pi * x[0];
  const auto s = turn / b[3], t = turn / b[6];
  return b[0] + b[1] * cos(turn / 12) + b[2] * sin(turn / 12) + b[4] * cos(s) + b[5] * sin(s) + b[7] * cos(t) +
         b[8] * sin(t);
};

template <class F>
constexpr NistModel Of(const char* name, int parameters, F) {
  return {name, parameters, &PoseRegression<F>};
}

constexpr NistModel WithNote(NistModel model, double deviation_digits, const char* note) {
  model.deviation_digits = deviation_digits;
  model.note = note;
  return model;
}

constexpr NistModel OfLogResponse(NistModel model, int predictors) {
  model.log_response = true;
  model.predictors = predictors;
  return model;
}

constexpr NistModel kModels[] = {
    Of("Bennett5", 3, [](auto b, auto x) { return b[0] * pow(b[1] + x[0], -1.0 / b[2]); }),
    Of("BoxBOD", 2, kSaturation),
    Of("Chwirut1", 3, kChwirut),
    Of("Chwirut2", 3, kChwirut),
    Of("DanWood", 2, [](auto b, auto x) { return b[0] * exp(b[1] * log(x[0])); }),
    Of("ENSO", 9, kEnso),
    Of("Eckerle4", 3,
       [](auto b, auto x) {
         const auto s = (x[0] - b[2]) / b[1];
         return b[0] / b[1] * exp(-0.5 * s * s);
       }),
    Of("Gauss1", 8, kGauss),
    Of("Gauss2", 8, kGauss),
    Of("Gauss3", 8, kGauss),
    Of("Hahn1", 7, kCubicByCubic),
    Of("Kirby2", 5,
       [](auto b, auto x) { return (b[0] + x[0] * (b[1] + x[0] * b[2])) / (1.0 + x[0] * (b[3] + x[0] * b[4])); }),
    WithNote(Of("Lanczos1", 6, kLanczos), 2,
             "its residual standard deviation, 8.9e-14, is at the level of rounding of its data: about 3 digits of the "
             "standard deviations are all that doubles can give"),
    Of("Lanczos2", 6, kLanczos),
    Of("Lanczos3", 6, kLanczos),
    Of("MGH09", 4,
       [](auto b, auto x) { return b[0] * (x[0] * x[0] + x[0] * b[1]) / (x[0] * x[0] + x[0] * b[2] + b[3]); }),
    Of("MGH10", 3, [](auto b, auto x) { return b[0] * exp(b[1] / (x[0] + b[2])); }),
    Of("MGH17", 5, [](auto b, auto x) { return b[0] + b[1] * exp(-x[0] * b[3]) + b[2] * exp(-x[0] * b[4]); }),
    Of("Misra1a", 2, kSaturation),
    Of("Misra1b", 2, [](auto b, auto x) { return b[0] * (1.0 - pow(1.0 + b[1] * x[0] / 2.0, -2.0)); }),
    Of("Misra1c", 2, [](auto b, auto x) { return b[0] * (1.0 - pow(1.0 + 2.0 * b[1] * x[0], -0.5)); }),
    Of("Misra1d", 2, [](auto b, auto x) { return b[0] * b[1] * x[0] / (1.0 + b[1] * x[0]); }),
    OfLogResponse(Of("Nelson", 3, [](auto b, auto x) { return b[0] - b[1] * x[0] * exp(-b[2] * x[1]); }), 2),
    Of("Rat42", 3, [](auto b, auto x) { return b[0] / (1.0 + exp(b[1] - b[2] * x[0])); }),
    Of("Rat43", 4, [](auto b, auto x) { return b[0] / pow(1.0 + exp(b[1] - b[2] * x[0]), 1.0 / b[3]); }),
    Of("Roszman1", 4,
       [](auto b, auto x) { return b[0] - b[1] * x[0] - atan(b[2] / (x[0] - b[3])) / std::numbers::pi; }),
    Of("Thurber", 7, kCubicByCubic),
};

}  // namespace

std::span<const NistModel> NistModels() { return kModels; }

}  // namespace scancal
