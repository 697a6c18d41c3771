// What the simulator promises of form, background and random streams.
#include "models/turntable/simulate.h"
#include <gtest/gtest.h>
#include <cmath>
#include <functional>

namespace scancal::turntable {
namespace {

constexpr PlateRectangle kOver = {30, -10, 120, 90};

// Mean over the rectangle of something of (u, v), u and v from -1 to 1; exact to 1e-3 for smooth forms.
double Mean(const PlateForm& form, const std::function<double(double height, double u, double v)>& of) {
  constexpr int kSide = 31;
  double sum = 0;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      const double u = (2 * i + 1.0) / kSide - 1, v = (2 * j + 1.0) / kSide - 1;
      const double height = form.At(kOver.centre_u + kOver.half_u * u, kOver.centre_v + kOver.half_v * v);
      sum += of(height, u, v) / (kSide * kSide);
    }
  }
  return sum;
}

double MeanSquare(const PlateForm& form) {
  return Mean(form, [](double height, double, double) { return height * height; });
}

TEST(PlateForm, OfModesHasItsRmsOverTheEnsemble) {
  constexpr int kPlates = 600;
  double sum = 0, squares = 0, bend = 0;
  for (uint64_t seed = 1; seed <= kPlates; ++seed) {
    const PlateForm form(FormKind::kModes, 0.005, kOver, Random(seed, 0));
    const double mean_square = MeanSquare(form) / (0.005 * 0.005);
    sum += mean_square / kPlates;
    squares += mean_square * mean_square / kPlates;
    // Its share of one mode of degree 2: sqrt(5) P2(u), orthonormal.
    const double amplitude =
        Mean(form, [](double height, double u, double) { return height * std::sqrt(5.0) * (1.5 * u * u - 0.5); });
    bend += amplitude * amplitude / (0.005 * 0.005) / kPlates;
  }
  const double standard_error = std::sqrt((squares - sum * sum) / kPlates);
  EXPECT_LT(standard_error, 0.05);
  EXPECT_NEAR(sum, 1, 4 * standard_error);
  double all = 0;  // variance of degrees (i, j) ~ (i + aspect j)^-4
  for (int degree = 2; degree <= 4; ++degree)
    for (int j = 0; j <= degree; ++j) all += std::pow(degree - j + j * kOver.half_u / kOver.half_v, -4);
  const double expected = std::pow(2, -4) / all;
  EXPECT_NEAR(bend, expected, 4 * expected * std::sqrt(2.0 / kPlates));
}

TEST(PlateForm, HasNoPlane) {
  for (const FormKind kind : {FormKind::kModes, FormKind::kSmooth, FormKind::kBent}) {
    for (uint64_t seed = 1; seed <= 10; ++seed) {
      const PlateForm form(kind, 1, kOver, Random(seed, 0));
      EXPECT_NEAR(Mean(form, [](double height, double, double) { return height; }), 0, 0.01);
      EXPECT_NEAR(Mean(form, [](double height, double u, double) { return height * u; }), 0, 0.01);
      EXPECT_NEAR(Mean(form, [](double height, double, double v) { return height * v; }), 0, 0.01);
    }
  }
}

TEST(PlateForm, OfWavesHasItsRmsItselfAndIsNoSumOfModes) {
  double not_modes = 0;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const PlateForm form(FormKind::kSmooth, 0.005, kOver, Random(seed, 0));
    EXPECT_NEAR(std::sqrt(MeanSquare(form)), 0.005, 1e-5);
    // P5(u) is orthogonal to all modes.
    const auto fifth = [](double u) { return std::sqrt(11.0) * std::legendre(5, u); };
    not_modes += std::abs(Mean(form, [&](double height, double u, double) { return height * fifth(u); })) / 0.005 / 10;
  }
  EXPECT_GT(not_modes, 0.01);
}

TEST(PlateForm, StretchesToAnotherRectangle) {
  const PlateRectangle wider = {0, 0, 2 * kOver.half_u, 2 * kOver.half_v};
  for (const FormKind kind : {FormKind::kModes, FormKind::kSmooth, FormKind::kBent}) {
    const PlateForm a(kind, 1, kOver, Random(1, 0)), b(kind, 1, wider, Random(1, 0));
    EXPECT_NEAR(a.At(30 + 50, -10 + 40), b.At(100, 80), 1e-12);
  }
}

Scene ExactScene() {
  Scene scene;
  scene.profiles = 21;
  scene.points = 30;
  scene.noise_y = 0;
  return scene;
}

// Along the normal, of every point of every placement.
std::vector<std::vector<double>> Heights(const Scene& scene) {
  std::vector<std::vector<double>> heights;
  for (const SimulatedPlacement& placement : Simulate(scene)) {
    std::vector<double>& of_placement = heights.emplace_back();
    for (const SimulatedProfile& profile : placement.profiles)
      for (size_t i = 0; i < profile.y.size(); ++i)
        of_placement.push_back(placement.normal.dot(scene.system.Point(profile.alpha, profile.y[i], profile.z[i])) -
                               placement.distance);
  }
  return heights;
}

double Product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i] / static_cast<double>(a.size());
  return sum;
}

TEST(Simulate, FormIsWhatThePointsShow) {
  Scene scene = ExactScene();
  scene.form = 0.01;
  constexpr int kScenes = 100;
  double sum = 0, squares = 0, between = 0;
  for (int k = 0; k < kScenes; ++k) {
    scene.seed = static_cast<uint64_t>(k) + 1;
    const auto heights = Heights(scene);
    const double mean_square = Product(heights[0], heights[0]) / 1e-4;
    sum += mean_square / kScenes;
    squares += mean_square * mean_square / kScenes;
    between += Product(heights[0], heights[1]) / 1e-4 / kScenes;
  }
  // What is seen is not quite the rectangle: its corners, where modes are large, are missing.
  EXPECT_NEAR(sum, 1, 0.05 + 4 * std::sqrt((squares - sum * sum) / kScenes));
  EXPECT_NEAR(between, 0, 4 / std::sqrt(5.0 * kScenes));  // about five modes of equal weight: independent placements
}

TEST(Simulate, OnePlateHasOneForm) {
  Scene scene = ExactScene();
  scene.form = 0.01;
  scene.one_plate = true;
  for (const FormKind kind : {FormKind::kModes, FormKind::kSmooth, FormKind::kBent}) {
    scene.form_kind = kind;
    const auto heights = Heights(scene);
    const double correlation =
        Product(heights[0], heights[2]) / std::sqrt(Product(heights[0], heights[0]) * Product(heights[2], heights[2]));
    EXPECT_GT(correlation, 0.7);  // seen from both sides, stretched a little differently
  }
}

TEST(Simulate, FormDoesNotShiftTheNoise) {
  Scene scene = ExactScene();
  const auto flat = Simulate(scene);
  scene.form = 0.01;
  const auto bent = Simulate(scene);
  scene.noise_y = 0.05;
  scene.outliers = 0.1;
  const auto noisy_bent = Simulate(scene);
  scene.form = 0;
  const auto noisy = Simulate(scene);
  for (size_t i = 0; i < 30; ++i)
    EXPECT_NEAR(noisy_bent[1].profiles[3].y[i] - noisy[1].profiles[3].y[i],
                bent[1].profiles[3].y[i] - flat[1].profiles[3].y[i], 1e-12);
}

TEST(Simulate, BackgroundIsOneRunAtEitherEnd) {
  Scene scene = ExactScene();
  scene.noise_y = 0.05;
  const auto clean = Simulate(scene);
  scene.background = 0.3;
  const auto disturbed = Simulate(scene);
  double wall_of_first = 0;
  for (size_t t = 0; t < 3; ++t) {
    int at_start = 0;
    double wall = 0;
    for (size_t k = 0; k < 21; ++k) {
      std::vector<double> apart;
      for (size_t i = 0; i < 30; ++i) apart.push_back(disturbed[t].profiles[k].y[i] - clean[t].profiles[k].y[i]);
      const bool start = apart[0] > 0;
      at_start += start;
      wall = start ? apart[0] : apart[29];
      for (size_t i = 0; i < 30; ++i) {
        if (start ? i < 9 : i >= 21) {
          EXPECT_NEAR(apart[i], wall, 1e-9);
        } else {
          EXPECT_EQ(apart[i], 0);
        }
      }
    }
    EXPECT_GE(wall, 30);
    EXPECT_LE(wall, 60);
    EXPECT_NE(wall, wall_of_first);
    if (t == 0) wall_of_first = wall;
    EXPECT_GT(at_start, 3);  // of 21: binomial, 1 in 1000
    EXPECT_LT(at_start, 18);
  }
}

TEST(Simulate, OneProfileOfOnePointMayHaveForm) {
  Scene scene = ExactScene();
  scene.profiles = scene.points = 1;
  scene.form = 0.01;
  for (const FormKind kind : {FormKind::kModes, FormKind::kSmooth, FormKind::kBent}) {
    scene.form_kind = kind;
    EXPECT_LT(std::abs(Heights(scene)[0][0]), 0.1);
  }
}

TEST(Simulate, SweepsBackDriftsAndRoundsAngles) {
  Scene scene = ExactScene();
  scene.profiles = 21;
  const auto plain = Simulate(scene);
  scene.back = true;
  const auto back = Simulate(scene);
  EXPECT_EQ(back[0].profiles[0].alpha, plain[0].profiles[0].alpha);
  EXPECT_NEAR(back[0].profiles[10].alpha, scene.sweep / 2, 1e-15);
  EXPECT_NEAR(back[0].profiles[20].alpha, -scene.sweep / 2, 1e-15);
  EXPECT_NEAR(back[0].profiles[20].y[0], back[0].profiles[0].y[0], 1e-9);
  scene.drift_sweep = 0.2;
  scene.drift = 0.3;
  scene.angle_step = 0.5 * kDegree;
  const auto drifted = Simulate(scene);
  for (size_t t = 0; t < drifted.size(); ++t) {
    for (size_t i = 0; i < 21; ++i) {
      const double elapsed = static_cast<double>(i) / 20;
      EXPECT_NEAR(drifted[t].profiles[i].y[0] - back[t].profiles[i].y[0],
                  0.2 * elapsed + 0.3 * (static_cast<double>(t) + elapsed) / static_cast<double>(drifted.size()), 1e-9);
      const double steps = drifted[t].profiles[i].alpha / scene.angle_step;
      EXPECT_NEAR(steps, std::round(steps), 1e-9);
      EXPECT_LE(std::abs(drifted[t].profiles[i].alpha - back[t].profiles[i].alpha), scene.angle_step / 2 + 1e-12);
    }
  }
}

TEST(Simulate, ProfilesErrTogetherWithTheirNeighbours) {
  Scene scene = ExactScene();
  scene.profiles = 2000;
  scene.points = 1;
  scene.placements = 1;
  const auto plain = Simulate(scene);
  scene.profile_offset = 0.02;
  scene.profile_correlation = 0.8;
  const auto with = Simulate(scene);
  double squares = 0, products = 0, before = 0;
  for (size_t i = 0; i < 2000; ++i) {
    const double error = with[0].profiles[i].y[0] - plain[0].profiles[i].y[0];
    squares += error * error;
    products += error * before;
    before = error;
  }
  EXPECT_NEAR(std::sqrt(squares / 2000), 0.02, 0.003);
  EXPECT_NEAR(products / squares, 0.8, 0.06);
}

}  // namespace
}  // namespace scancal::turntable
