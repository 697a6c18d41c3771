// Delimited text: lines of cells between commas (RFC 4180), in files of any size.
#pragma once
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include "io/decoded_file.h"
#include "io/dialect.h"
#include "io/number.h"
#include "io/result.h"

namespace scancal {

// Read block by block, each block a number of whole lines. Every line ends with '\n', also a last one that has none in
// the file: whoever walks over a line needs no other check for its end. A byte order mark is skipped. Read() rather
// than a mapping: a pipe will do, and a file that shrinks meanwhile is an error instead of a SIGBUS.
class TextLines {
 public:
  static Result<TextLines> Open(const std::filesystem::path& path);
  static Result<TextLines> Open(DecodedFile file);
  // Makes sure that there is a line; false at the end of the file. Invalidates pointers into the old block.
  Result<bool> Fill();
  const char* begin() const { return begin_; }  // the next line
  const char* end() const { return end_; }      // of the last whole line in the block
  void SkipTo(const char* line) { begin_ = line; }
  // The next line, without its end; nothing at the end of the file.
  Result<std::optional<std::string_view>> TakeLine();
  const std::string& name() const { return file_.name(); }
  // From here on as commas between cells and decimal points.
  void Translate(const Dialect& dialect);
  int64_t bytes_read() const { return file_.bytes_read() - (file_.wrapping().empty() ? filled_end_ - begin_ : 0); }
  int64_t bytes_total() const { return file_.size(); }
  const std::string& wrapping() const { return file_.wrapping(); }

 private:
  explicit TextLines(DecodedFile file);
  Result<void> ReadMore();
  Result<void> CheckEncoding();

  DecodedFile file_;
  Dialect dialect_;
  std::vector<char> buffer_;
  const char* begin_;       // lines not yet taken: [begin_, end_)
  const char* end_;         //
  const char* filled_end_;  // an unfinished line: [end_, filled_end_)
  bool at_end_ = false;
};

enum class Cells {
  kIgnored,        // anything; a quote behind a blank does not open it (RFC 4180)
  kTextOrNothing,  // nothing: empty
  kText,
  kNumber,
  kNumberOrNothing  // nothing: empty or nan, reads as nan
};

struct ExpectedCells {  // of a column
  Cells cells = Cells::kIgnored;
  std::string name = {};  // for messages
};

// A cell, unquoted, says this: as numbers if both are, else as text.
bool CellIs(const std::string& cell, const std::string& value, const Dialect& dialect = {});

// How many cells a row has, and what is told if a number in it is wrong as well.
enum class CellCount {
  kFirst,  // one for each column; their count: the line is cut off, or has other separators
  kLast,   // one for each column; the number
  kAny     // the last column is that of all further cells, too; the number
};

// A text file row by row. Lines that are blank or begin with # are no rows. Cells and rows other than expected are
// errors with their file, line and column.
class DelimitedText {
 public:
  static Result<DelimitedText> Open(const std::filesystem::path& path);
  static Result<DelimitedText> Open(DecodedFile file);

  // From the first line on: finds the head of the file (FindHead, else FindNumbers) and takes it.
  // What follows reads as commas between cells and decimal points, whatever the file has.
  // match: none where names tell nothing; nameless: what is looked for where no line has the wanted names.
  Result<TextHead> TakeHead(const TextFormat& declared, const ColumnMatcher& match,
                            const std::optional<NumberRows>& nameless);

  Result<std::string_view> Peek();  // the next row, without its end; empty at the end of the file
  void Skip();                      // takes the row that Peek found
  // From the next row on. header: as the file names its columns, for messages.
  void Expect(std::vector<ExpectedCells> columns, std::vector<std::string> header, CellCount count);
  // Rows before the first and behind the last of these lines of the file, 1-based, are left out.
  void KeepLines(int64_t first, int64_t last);
  // Texts that stand for a number that is missing; only rows with these values in these columns.
  void TreatAsMissing(std::vector<std::string> texts) { missing_ = std::move(texts); }
  void KeepWhere(std::vector<std::pair<size_t, std::string>> where) { where_ = std::move(where); }
  // What the first row that KeepWhere leaves out has in these columns; empty: there is none.
  const std::string& first_unwanted() const { return first_unwanted_; }
  // "gzip, cells between semicolons, decimal commas, names in line 15"; empty: a plain file.
  std::string Describe() const;

  Result<bool> Next();  // takes a row as expected; false at the end
  // Of the row in hand, as it stands there.
  size_t cells() const { return cells_; }
  double Number(size_t column) const { return columns_[column].number; }
  std::string Text(size_t column) const;
  size_t Start(size_t column);  // of the cell in its line, in characters, 1-based; ask from left to right

  const std::string& name() const { return text_.name(); }
  int64_t line() const { return line_; }  // of the row in hand; at the end: the number of lines
  std::string Place() const { return name() + ":" + std::to_string(line_); }
  // Hints for complaints about the row in hand, empty if there is none.
  std::string WrongSeparator() const;  // "; the cells are separated by semicolons, expected commas"
  std::string CutOff();                // "; the file is probably cut off here": no line follows. Takes the row.
  int64_t bytes_read() const { return text_.bytes_read(); }
  int64_t bytes_total() const { return text_.bytes_total(); }

 private:
  struct Column {
    Cells cells = Cells::kIgnored;
    char behind = ',';
    ColumnParser parser;
    const char* start = nullptr;  // of the cell in hand
    double number = 0;
  };

  explicit DelimitedText(TextLines text) : text_(std::move(text)) {}
  std::string_view Line() const;
  Column* AddColumn();
  Error Wrong(const Column* column);
  std::vector<std::string_view> FirstLines() const;
  void TakeLines(const TextHead& head);
  const char* TakeCells(const char* at, const Column** wrong);
  bool IsUnwanted();
  bool IsHeadAgain() const;
  const char* ReadCell(const char* at, const char* end, Cells cells, ColumnParser& parser, double* number) const;
  const char* ReadCellCarefully(const char* at, Cells cells, double* number) const;

  TextLines text_;
  std::vector<Column> columns_;
  std::vector<ExpectedCells> expected_;
  std::vector<std::string> header_;
  CellCount count_ = CellCount::kLast;
  TextHead head_;
  std::string first_unwanted_;
  std::string names_, units_;  // their lines, translated: a file that was appended to has them again
  std::vector<std::string> missing_;
  std::vector<std::pair<size_t, std::string>> where_;
  int64_t line_ = 0, first_line_ = 1, last_line_ = std::numeric_limits<int64_t>::max();
  size_t cells_ = 0;
  const char* line_start_ = nullptr;  // of the line in hand
  int64_t counted_line_ = 0;          // Start() knows the number of characters in this line ...
  const char* counted_ = nullptr;     // ... up to here
  size_t characters_ = 0;
};

}  // namespace scancal
