// How a file of delimited text is written: what separates its cells, its decimal sign, what stands before its data.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include "io/result.h"

namespace scancal {

// As a data set declares it; what it leaves open is found from the content, once a file.
struct TextFormat {
  std::optional<char> separator;                           // , ; tab, or a blank: any number of blanks and tabs
  std::optional<char> decimal;                             // . or ,
  std::optional<int64_t> header_lines;                     // before the first line of data
  std::optional<bool> windows_1252;                        // else UTF-8; UTF-16 is told from its bytes
  std::vector<std::string> missing;                        // texts in place of a number
  std::vector<std::pair<std::string, std::string>> where;  // only rows with this value in the column of this name
};

// What a quoted number with commas between digits means, "1,234".
enum class QuotedCommas { kUnknown, kThousands, kDecimal };

// From the file's bytes to commas between cells and decimal points, and back. Length and lines stay as they are, so
// that places in messages are those of the file.
class Dialect {
 public:
  char separator = ',', decimal = '.';
  QuotedCommas quoted = QuotedCommas::kUnknown;  // where cells are separated by commas
  bool windows_1252 = false;
  bool is_plain() const { return separator == ',' && decimal == '.'; }

  void Translate(char* begin, char* end) const;       // whole lines
  std::string Original(std::string_view text) const;  // what was there, in UTF-8
  // A number that ParseNumber does not read, in quotes and with separators of thousands or a decimal comma, is made one
  // that it reads; translated text.
  std::optional<std::string> Unquoted(std::string_view cell) const;
  // "cells between semicolons, decimal commas"; empty: plain.
  std::string Describe() const;
};

struct TextHead {  // of a file
  Dialect dialect;
  std::vector<std::string> names;  // of the columns; empty: it has none
  std::vector<std::string> units;  // from a row of their own below the names; empty: none
  size_t names_line = 0;           // 1-based; 0: none
  size_t lines = 0;                // before the first line of data
  bool is_nameless = false;        // from the columns of a data set, not of the file
  bool is_known = false;           // false: no line has the wanted names, `names` is what looks most like them
};

// The columns of numbers that are wanted among these names; none: the row is no header.
using ColumnMatcher = std::function<std::vector<size_t>(const std::vector<std::string>& names)>;

// The head of a file whose first lines are these: the first line that has the wanted names, whatever separates them, a
// row of units below it; the decimal sign of the rows that follow. "sep=;" in the first line counts. A file that reads
// in two ways is an Error that shows both.
Result<TextHead> FindHead(const std::vector<std::string_view>& lines, const TextFormat& declared,
                          const ColumnMatcher& match, const std::string& file);

// The same of a file without names, or with names that nobody needs: the first row of at least (if `exactly`, of)
// `cells` cells whose columns `numbers` (none: all from the last of them on) are numbers. names: of the line above.
struct NumberRows {
  size_t cells = 1;
  bool exactly = true;
  std::vector<size_t> numbers;
};
Result<TextHead> FindNumbers(const std::vector<std::string_view>& lines, const TextFormat& declared,
                             const NumberRows& rows, const std::string& file);

// What the cells of a line say: without blanks and quotes around them, and a doubled quote within quotes is one. A cell
// in quotes may hold separators.
std::vector<std::string> SplitCells(std::string_view line, char separator = ',');

}  // namespace scancal
