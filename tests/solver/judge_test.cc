// Doubts that the solver itself can name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include "solver/calibrate.h"
#include "tests/solver/line_model.h"

namespace scancal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Calibration Calibrated(const std::vector<LineModel::Target>& targets, const LineModel& model = {}, double noise = 0.1) {
  Problem problem = MakeProblem<LineModel>(std::make_shared<LineModel>(model), targets);
  problem.WeighEqually(noise);
  const Estimate start = NominalStart(problem);
  return Summarize(Solve(std::move(problem), start), {});
}

TEST(Judge, HasNoDoubtAboutSoundData) { EXPECT_THAT(Calibrated(LineScene().Make()).unreliable, IsEmpty()); }

TEST(Judge, NamesAPriorThatTheDataContradict) {
  LineModel model;
  model.quantity(LineModel::kSlope).value = 1;  // the data say 0.3(0.01)
  model.quantity(LineModel::kSlope).u = 0.01;
  const std::vector<Sentence> doubts = Calibrated(LineScene().Make(), model).unreliable;
  EXPECT_THAT(doubts, ElementsAre(HasSubstr("slope: its prior and the data disagree")));
  EXPECT_THAT(doubts[0].german, HasSubstr("slope: Vorwissen und Daten widersprechen einander"));
  model.quantity(LineModel::kSlope).value = 0.3;
  EXPECT_THAT(Calibrated(LineScene().Make(), model).unreliable, IsEmpty());
}

TEST(Judge, WantsMoreViewsThanQuantities) {
  LineScene scene;
  scene.views = 1;
  EXPECT_THAT(Calibrated(scene.Make()).unreliable, ElementsAre(HasSubstr("too few views")));
}

TEST(Judge, NamesTargetsThatContradictEachOther) {
  LineScene scene;
  scene.targets = 6;  // with three, one deviant is half of what the others are judged by
  scene.views = 30;
  auto targets = scene.Make();
  for (size_t t = 3; t < targets.size(); ++t)
    for (LineModel::View& view : targets[t].views)
      for (size_t i = 0; i < view.y.size(); ++i) view.y[i] += 0.2 * view.x[i];  // another slope
  EXPECT_THAT(Calibrated(targets).unreliable, ElementsAre(HasSubstr("slope: leaving one target out moves it")));
}

}  // namespace
}  // namespace scancal
