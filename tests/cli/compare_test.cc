// scancal compare: one row a method, and the surface of the published search.
#include <gmock/gmock.h>
#include <limits>
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr char kFine[] = "--steps=1,0.1,0.01";

class CompareTest : public CliTest {
 protected:
  // The finest grid has 100 x 100 nodes per square millimetre.
  fs::path SmallSearch() const {
    Simulate(Path("data"), {"--profiles=40", "--points=20", "--search_width_M=2", "--search_width_N=3"});
    return Path("data");
  }
  // The rows of the table on stdout, without header and rule.
  static std::vector<std::string> Rows(const std::string& out) {
    std::vector<std::string> rows;
    bool inside = false;
    for (const std::string& line : Lines(out)) {
      if (inside && line.find("grid, ") != 0 && line.find("joint, ") != 0) break;
      if (inside) rows.push_back(line);
      inside |= line.starts_with("-----");
    }
    return rows;
  }
  // The first numbers behind the method's name, in concise notation or not.
  static std::vector<double> Numbers(const std::string& row, const std::string& method) {
    std::vector<double> numbers;
    std::istringstream cells(row.substr(method.size()));
    for (std::string cell; cells >> cell;) numbers.push_back(std::atof(cell.c_str()));
    return numbers;
  }
};

TEST_F(CompareTest, RowsInTheirOrder) {
  const Outcome outcome = RunScancal({"compare", SmallSearch().string(), kFine, "--wide"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const std::vector<std::string> rows = Rows(outcome.out);
  const std::vector<std::string> methods = {"grid, as published, step 1",    "grid, as published, step 0.1",
                                            "grid, as published, step 0.01", "grid, orthogonal, step 1",
                                            "grid, orthogonal, step 0.1",    "grid, orthogonal, step 0.01",
                                            "joint, point to plane",         "joint, depth",
                                            "joint, depth, weighted, tilts", "joint, depth, weighted"};
  ASSERT_EQ(rows.size(), methods.size()) << outcome.out;
  // Nodes stand before the seconds, at the end of the row.
  const std::vector<double> nodes = {12, 651, 60501, 12, 651, 60501};
  for (size_t k = 0; k < methods.size(); ++k) {
    EXPECT_THAT(rows[k], StartsWith(methods[k] + "  "));
    const std::vector<double> numbers = Numbers(rows[k], methods[k]);
    ASSERT_GE(numbers.size(), 12U) << rows[k];
    EXPECT_NEAR(numbers[0], 123, 1) << rows[k];
    EXPECT_NEAR(numbers[1], 409, 1.5) << rows[k];
    if (k < nodes.size()) {
      EXPECT_EQ(numbers[numbers.size() - 2], nodes[k]) << rows[k];
    }
  }
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("held out"), HasSubstr("step/√12"), HasSubstr("tilt_x/mrad")));
}

TEST_F(CompareTest, AFinerGridComesNearerToTheJointFit) {
  const Outcome outcome = RunScancal({"compare", SmallSearch().string(), kFine, "--wide"});
  const std::vector<std::string> rows = Rows(outcome.out);
  ASSERT_EQ(rows.size(), 10U);
  const auto depth = Numbers(rows[7], "joint, depth"), plane = Numbers(rows[6], "joint, point to plane"),
             fine = Numbers(rows[5], "grid, orthogonal, step 0.01"),
             finer_than = Numbers(rows[4], "grid, orthogonal, step 0.1");
  EXPECT_NEAR(fine[0], plane[0], 0.011);  // the same objective up to the weight of the placements
  EXPECT_NEAR(fine[1], plane[1], 0.05);
  EXPECT_NEAR(finer_than[0], plane[0], 0.11);
  EXPECT_NEAR(depth[0], plane[0], 0.08);  // one u
}

TEST_F(CompareTest, OnePlacementHasNoHeldOutResidual) {
  Simulate(Path("data"),
           {"--placements=1", "--profiles=40", "--points=20", "--search_width_M=2", "--search_width_N=3"});
  const Outcome outcome = RunScancal({"compare", Path("data").string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const std::string& row : Rows(outcome.out)) EXPECT_THAT(row, HasSubstr(" - ")) << row;
  EXPECT_EQ(Rows(outcome.out).size(), 8U);
}

TEST_F(CompareTest, StepsThatAreNoneAreRefused) {
  for (const char* steps : {"", "1,", "0", "-0.1", "1;0.1", "fine", "nan"}) {
    const Outcome outcome = RunScancal({"compare", "data", std::string("--steps=") + steps});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(OneSentence(outcome), AllOf(HasSubstr("--steps"), HasSubstr("as 1,0.1"))) << steps;
  }
}

TEST_F(CompareTest, TheSurfaceHasEveryNodeAndItsMinimumWhereItIsReported) {
  const fs::path data = SmallSearch(), surface = Path("the surface's.csv");
  Replace(data / "dataset.yaml", "step: 1", "step: 0.25");
  ASSERT_EQ(RunScancal({"compare", data.string(), "--surface=" + surface.string()}).exit_code, 0);
  const std::vector<std::string> lines = Lines(ReadWhole(surface));
  ASSERT_EQ(lines.size(), 1U + 9 * 13);
  EXPECT_EQ(lines[0], "M_mm,N_mm,S_published_mm,S_orthogonal_mm");
  double least = std::numeric_limits<double>::infinity(), M = 0, N = 0;
  for (size_t i = 1; i < lines.size(); ++i) {
    double at_M = 0, at_N = 0, published = 0, orthogonal = 0;
    ASSERT_EQ(std::sscanf(lines[i].c_str(), "%lf,%lf,%lf,%lf", &at_M, &at_N, &published, &orthogonal), 4) << lines[i];
    EXPECT_GE(published, orthogonal - 1e-12);  // least squares in Z, then orthogonal distances: never the least ones
    if (orthogonal >= least) continue;
    least = orthogonal;
    M = at_M;
    N = at_N;
  }
  const Json result = Refined(data);
  EXPECT_EQ(result["grid"]["M"], M);
  EXPECT_EQ(result["grid"]["N"], N);
  EXPECT_NEAR(result["grid"]["S"], least, 1e-9 * least);
  EXPECT_EQ(result["grid"]["nodes"], 9 * 13);
  EXPECT_EQ(result["grid"]["step"], 0.25);
}

TEST_F(CompareTest, ABadDataSetWritesNoSurface) {
  const fs::path data = SmallSearch();
  fs::remove(data / "right.csv");
  const Outcome outcome = RunScancal({"compare", data.string(), "--surface=" + Path("s.csv").string()});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(OneSentence(outcome), HasSubstr("right.csv: no such file"));
  EXPECT_FALSE(fs::exists(Path("s.csv")));
}

TEST_F(CompareTest, ASurfaceThatCannotBeWrittenIsTold) {
  const fs::path data = SmallSearch();
  WriteWhole(Path("file"), "");
  const Outcome outcome = RunScancal({"compare", data.string(), "--surface=" + Path("file/s.csv").string()});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(OneSentence(outcome), HasSubstr("is a file, expected a folder"));
}

}  // namespace
}  // namespace scancal
