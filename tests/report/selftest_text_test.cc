#include <gmock/gmock.h>
#include "report/text.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

SelftestRow Row(const std::string& name, double digits, double digits_of_u) {
  SelftestRow row;
  row.name = name;
  row.values = {digits, 8};
  row.deviations = {digits_of_u, 6};
  return row;
}

TEST(SelftestText, OneRowShortOfItsDigitsFailsAll) {
  SelftestRow good = Row("one", 10.5, 6), bad = Row("two", 7.99, 11);
  good.level = "Higher";
  good.observations = 250;
  good.parameters = 8;
  good.iterations = 9;
  bad.note = "its reference is wrong";
  EXPECT_THAT(ToText(Selftest{{good}}), EndsWith("\n1 of 1 cases passed\nselftest: pass\n"));
  EXPECT_THAT(
      ToText(Selftest{{good, bad}}),
      AllOf(
          StartsWith(
              "case  difficulty  observations  parameters  digits  required  digits of u  required  iterations\n"
              "-----------------------------------------------------------------------------------------------------\n"
              "one       Higher           250           8    10.5       8.0          6.0       6.0           9  pass\n"
              "two            -             -           -     7.9       8.0         11.0       6.0           -  "
              "FAIL\n"),
          HasSubstr("\ntwo: its reference is wrong\n"), EndsWith("\n1 of 2 cases passed\nselftest: FAIL\n")));
  EXPECT_FALSE(Row("u", 11, 5.9).pass());
}

}  // namespace
}  // namespace scancal
