// Text of lines and cells.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include "io/input_file.h"
#include "io/number.h"
#include "io/result.h"

namespace scancal {

// A text file of any size, read block by block, each block a number of whole lines.
//
// Every line ends with '\n', also a last one that has none in the file: whoever walks over a line needs no other check
// for its end. A byte order mark is skipped. Read() rather than a mapping: a pipe will do, and a file that shrinks
// meanwhile is an error instead of a SIGBUS.
class TextLines {
 public:
  static Result<TextLines> Open(const std::filesystem::path& path);
  // Makes sure that there is a line; false at the end of the file. Invalidates pointers into the old block.
  Result<bool> Fill();
  const char* begin() const { return begin_; }  // the next line
  const char* end() const { return end_; }      // of the last whole line in the block
  void SkipTo(const char* line) { begin_ = line; }
  // The next line, without its end; nothing at the end of the file.
  Result<std::optional<std::string_view>> TakeLine();
  const std::string& name() const { return file_.name(); }
  int64_t bytes_read() const { return bytes_read_ - (filled_end_ - begin_); }
  int64_t bytes_total() const { return file_.size(); }

 private:
  explicit TextLines(InputFile file);
  Result<void> ReadMore();
  Result<void> CheckEncoding();

  InputFile file_;
  std::vector<char> buffer_;
  const char* begin_;       // lines not yet taken: [begin_, end_)
  const char* end_;         //
  const char* filled_end_;  // an unfinished line: [end_, filled_end_)
  int64_t bytes_read_ = 0;
  bool at_end_ = false;
};

// These walk over a line that ends with '\n', from the start of a cell to the comma or the '\n' behind it. A cell in
// quotes may hold commas.

const char* SkipQuotedCell(const char* at);

inline const char* SkipCell(const char* at) {
  if (*at == '"') return SkipQuotedCell(at);
  while (*at != ',' && *at != '\n') ++at;
  return at;
}

const char* ReadCellCarefully(const char* at, ParsedNumber* number);

// A cell that is a plain number is read in one go, any other one by ReadCellCarefully. `end`: of the block of lines.
inline const char* ReadCell(const char* at, const char* end, ColumnParser& parser, ParsedNumber* number) {
  const char* start = at;
  while (*start == ' ') ++start;
  if (const char* number_end = parser.Parse(start, end, &number->value)) {
    if (*number_end == '\r') ++number_end;
    if (*number_end == ',' || *number_end == '\n') {
      number->kind = NumberKind::kNumber;
      return number_end;
    }
  }
  return ReadCellCarefully(at, number);
}

// What a cell says: without blanks and quotes around it, and a doubled quote within them is one (RFC 4180).
std::string CellText(std::string_view cell);

// For the lines that are no hurry: the headers and the wrong ones.
struct CsvField {
  std::string text;   // see CellText
  size_t column = 1;  // where it starts in the line, 1-based, in characters
};
std::vector<CsvField> SplitCells(std::string_view line);

// left.csv:1042:8: y: found "12.3.4", expected a number; `place` is left.csv:1042, `cell` starts in `line`, which is
// followed by '\n'.
Error WrongCsvCell(const std::string& place, std::string_view line, const char* cell, const std::string& name,
                   NumberKind kind);

// Blank, or a comment.
bool IsWithoutCells(std::string_view line);

// "; the cells are separated by semicolons, expected commas" if there is reason to think so, else empty.
std::string WrongSeparator(std::string_view line);

}  // namespace scancal
