// Tables with text and numbers.
#include "io/table.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include "tests/io/temporary_folder.h"

namespace scancal {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;

class TableTest : public ::testing::Test {
 protected:
  Result<Table> Read(const std::string& text) {
    return Table::Read(folder_.Write("t.csv", text),
                       {{"ball"},
                        {"x", Cells::kNumber, Dimension::kLength, true, "; name it x"},
                        {"q1", Cells::kNumber, Dimension::kAngle, false},
                        {"u", Cells::kNumberOrNothing, Dimension::kLength, false},
                        {"note", Cells::kText, Dimension::kNone, false}},
                       Units{});
  }
  std::string Error(const std::string& text) {
    const auto table = Read(text);
    return table.ok() ? "" : table.error().message;
  }
  TemporaryFolder folder_;
};

TEST_F(TableTest, AFileWithoutAHeader) {
  const auto read = [&](const std::string& text, const std::vector<std::string>& header) {
    return Table::Read(folder_.Write("t.csv", text), {{"x", Cells::kNumber, Dimension::kLength}}, Units{}, header);
  };
  const auto table = read("# logged\n1,2\n3,4\n", {"other", "x_m"});
  ASSERT_TRUE(table.ok()) << table.error().message;
  EXPECT_THAT(table->Numbers("x"), ElementsAre(2000, 4000));
  EXPECT_THAT(table->Wrong(0, "x", "so").message, EndsWith("t.csv:2:3: x_m: so"));
  EXPECT_THAT(read("1,2\n", {"a", "b"}).error().message, HasSubstr("t.csv: found the columns a, b, expected also 'x'"));
  EXPECT_THAT(read("", {"x"}).error().message, EndsWith("t.csv: found no line, expected lines of data"));
}

TEST_F(TableTest, NamedColumnsInAnyOrder) {
  const auto table = Read("x,other,ball\n1.5,?,A\n-2e1,,B\n");
  ASSERT_TRUE(table.ok()) << table.error().message;
  EXPECT_EQ(table->rows(), 2U);
  EXPECT_THAT(table->Texts("ball"), ElementsAre("A", "B"));
  EXPECT_THAT(table->Numbers("x"), ElementsAre(1.5, -20));
  EXPECT_EQ(table->Text("ball", 1), "B");
  EXPECT_EQ(table->Number("x", 0), 1.5);
  EXPECT_TRUE(table->Has("x"));
  EXPECT_FALSE(table->Has("q1"));
  EXPECT_FALSE(table->Has("other"));
}

// As a data set declares it, through the same code as a scan's.
TEST_F(TableTest, ADialectOtherNamesAndSomeRows) {
  ScanFormat format;
  format.path = folder_.Write("t.csv", "Log;of\n\nRobot;Kugel;Wert [m]\nR1;A;1,5\nR2;B;2,5\nR1;C;x\n");
  format.names = {{"ball", "Kugel"}, {"x", "Wert"}};
  format.text.where = {{"Robot", "R2"}};
  const std::vector<TableColumn> columns = {{"ball"}, {"x", Cells::kNumber, Dimension::kLength}};
  auto table = Table::Read(format, columns);
  ASSERT_TRUE(table.ok()) << table.error().message;
  EXPECT_THAT(table->Texts("ball"), ElementsAre("B"));
  EXPECT_THAT(table->Numbers("x"), ElementsAre(2500));
  EXPECT_EQ(table->dialect(), "cells between semicolons, decimal commas, names in line 3");
  EXPECT_THAT(table->Wrong(0, "x", "so").message, EndsWith("t.csv:5:6: Wert [m]: so"));  // as the file calls it
  format.text.where = {{"Robot", "R1"}};
  EXPECT_THAT(Table::Read(format, columns).error().message, HasSubstr("t.csv:6:6: Wert [m]: found \"x\""));
  format.text.where = {{"Robot", "R3"}};
  EXPECT_THAT(Table::Read(format, columns).error().message, HasSubstr("with what `where` asks for"));
  format.text.where = {{"Arm", "R3"}};
  EXPECT_THAT(Table::Read(format, columns).error().message, HasSubstr("t.csv:3: where: found the columns"));
}

TEST_F(TableTest, ANameThatIsDeclaredMustBeThereAndOnce) {
  ScanFormat format;
  format.path = folder_.Write("t.csv", "ball,x\nA,1\n");
  const std::vector<TableColumn> columns = {
      {"ball"}, {"x", Cells::kNumber, Dimension::kLength}, {"u", Cells::kNumberOrNothing, Dimension::kLength, false}};
  EXPECT_TRUE(Table::Read(format, columns).ok());
  format.names = {{"u", "sigma"}};
  EXPECT_THAT(Table::Read(format, columns).error().message, HasSubstr("expected also 'sigma'"));
  format.names = {{"u", "x"}};
  EXPECT_THAT(Table::Read(format, columns).error().message, HasSubstr("'x' is declared to be both x, u"));
}

TEST_F(TableTest, AUnitInTheNameWins) {
  const auto table = Read("ball,x_m,q1,u\nA,2,180,0.5\n");
  ASSERT_TRUE(table.ok()) << table.error().message;
  EXPECT_EQ(table->Number("x", 0), 2000);
  EXPECT_NEAR(table->Number("q1", 0), M_PI, 1e-15);
  EXPECT_EQ(table->Number("u", 0), 0.5);
  EXPECT_EQ(Read("ball,x,q1_rad\nA,1,3\n")->Number("q1", 0), 3);
}

TEST_F(TableTest, WhatIsNoPartOfTheCells) {
  const auto table =
      Read("\xEF\xBB\xBF \"ball\" , x\r\n\r\n# a comment\r\n \"Kugel 1, groß\" , \"1\" \r\n  B b\t,2\r\n\r\n\"C\",+3");
  ASSERT_TRUE(table.ok()) << table.error().message;
  EXPECT_THAT(table->Texts("ball"), ElementsAre("Kugel 1, groß", "B b", "C"));
  EXPECT_THAT(table->Numbers("x"), ElementsAre(1, 2, 3));
  EXPECT_THAT(table->Place(1), EndsWith("t.csv:5"));
}

TEST_F(TableTest, ADoubledQuoteIsOne) {
  const auto table =
      Read("\"ball\",x,\"say \"\"x_m\"\"\"\n\"3/4\"\" ball, \"\"A\"\"\",1,?\n\"\"\"\",2,?\n3/4\"\" B,3,?\n");
  ASSERT_TRUE(table.ok()) << table.error().message;
  EXPECT_THAT(table->Texts("ball"), ElementsAre("3/4\" ball, \"A\"", "\"", "3/4\"\" B"));
  EXPECT_THAT(table->Numbers("x"), ElementsAre(1, 2, 3));
  EXPECT_THAT(Error("ball,\"say \"\"x\"\"\"\nA,1\n"), HasSubstr("found the columns ball, say \"x\", expected"));
}

TEST_F(TableTest, AQuoteBehindABlankHoldsCommas) {
  const auto table = Read("other,ball,x\n \"a, b\", \"A, 1\",1\n,B,2\n");
  ASSERT_TRUE(table.ok()) << table.error().message;
  EXPECT_THAT(table->Texts("ball"), ElementsAre("A, 1", "B"));
  EXPECT_THAT(table->Wrong(0, "x", "w").message, EndsWith("t.csv:2:17: x: w"));
  EXPECT_THAT(Error("ball,x_m\nA,y\n"), EndsWith("t.csv:2:3: x_m: found \"y\", expected a number"));
}

TEST_F(TableTest, PlacesCountCharacters) {
  const auto table = Read("note,ball,x\ngrün, A,1\nrot,B,2\n");
  EXPECT_THAT(table->Wrong(0, "ball", "no such ball").message, EndsWith("t.csv:2:7: ball: no such ball"));
  EXPECT_THAT(table->Wrong(0, "x", "w").message, EndsWith("t.csv:2:9: x: w"));
  EXPECT_THAT(table->Wrong(1, "note", "w").message, EndsWith("t.csv:3:1: note: w"));
}

TEST_F(TableTest, NothingWhereItMayBe) {
  const auto table = Read("ball,x,u\nA,1,\nB,2,nan\nC,3,0.1\n");
  ASSERT_TRUE(table.ok()) << table.error().message;
  EXPECT_TRUE(std::isnan(table->Number("u", 0)));
  EXPECT_TRUE(std::isnan(table->Number("u", 1)));
  EXPECT_EQ(table->Number("u", 2), 0.1);
}

TEST_F(TableTest, WrongCellsAreNamed) {
  EXPECT_THAT(Error("ball,x\nA,1\nB,1.2.3\n"), EndsWith("t.csv:3:3: x: found \"1.2.3\", expected a number"));
  EXPECT_THAT(Error("ball,x\nA,\n"), HasSubstr("t.csv:2:3: x: found \"\", expected a number"));
  EXPECT_THAT(Error("ball,x\nA,inf\n"), HasSubstr("t.csv:2:3: x: found \"inf\", expected a finite number"));
  EXPECT_THAT(Error("ball,x,u\nA,1,inf\n"), HasSubstr("t.csv:2:5: u: found \"inf\""));
  EXPECT_THAT(Error("ball,x\n\"\",1\n"), HasSubstr("t.csv:2:1: ball: the cell is empty"));
  EXPECT_THAT(Error("ball,x\n,1\n"), HasSubstr("t.csv:2:1: ball: the cell is empty"));
}

TEST_F(TableTest, EveryLineHasAsManyCells) {
  EXPECT_THAT(Error("ball,x\nA,1\nB\n"), EndsWith("t.csv:3: found 1 cell, expected 2 (ball, x)"));
  EXPECT_THAT(Error("ball,x\nA,1,2\n"), EndsWith("t.csv:2: found 3 cells, expected 2 (ball, x)"));
  EXPECT_THAT(Error("ball,x,note\nA,\n"), HasSubstr("t.csv:2: found 2 cells, expected 3"));
  EXPECT_THAT(Error("ball,x,note\nA,1.2.3\n"), EndsWith("t.csv:2: found 2 cells, expected 3 (ball, x, note)"));
  EXPECT_THAT(Error("ball,x,note\n,1\n"), EndsWith("t.csv:2:1: ball: the cell is empty, expected text"));
  EXPECT_THAT(Error("ball,x\nA;1\n"), HasSubstr("separated by semicolons"));
}

TEST_F(TableTest, HeadersAreChecked) {
  EXPECT_THAT(Error("ball,y\nA,1\n"),
              EndsWith("t.csv:1: found the columns ball, y, expected also 'x' (or x_mm, _m, _um); name it x"));
  EXPECT_THAT(Error("ball;y\nA;1\n"), HasSubstr("semicolons"));
  EXPECT_THAT(Error("ball,x,x_mm\nA,1,1\n"), HasSubstr("the column 'x' twice"));
  EXPECT_THAT(Error(""), HasSubstr("the file is empty"));
  EXPECT_THAT(Error("# nothing\n"), HasSubstr("the file is empty"));
  EXPECT_THAT(Error("ball,x\n"), HasSubstr("no line below the header"));
}

TEST_F(TableTest, AMissingFileIsNamed) {
  const auto table = Table::Read(folder_.path() / "none.csv", {{"ball"}}, Units{});
  ASSERT_FALSE(table.ok());
  EXPECT_THAT(table.error().message, HasSubstr("none.csv: no such file"));
}

// Longer than a block of the file, so that lines are read across its end.
TEST_F(TableTest, ManyLines) {
  std::string text = "ball,x,u\n";
  for (int k = 0; k < 100'000; ++k) text += "ball number " + std::to_string(k % 8) + "," + std::to_string(k) + ".25,\n";
  const auto table = Read(text);
  ASSERT_TRUE(table.ok()) << table.error().message;
  ASSERT_EQ(table->rows(), 100'000U);
  for (size_t k = 0; k < table->rows(); k += 1001) {
    EXPECT_EQ(table->Number("x", k), static_cast<double>(k) + 0.25);
    EXPECT_EQ(table->Text("ball", k).back(), static_cast<char>('0' + k % 8));
  }
  EXPECT_THAT(table->Place(99'999), EndsWith(":100001"));
}

}  // namespace
}  // namespace scancal
