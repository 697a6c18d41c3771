#include "io/delimited.h"
#include <algorithm>
#include <cstring>
#include <utility>
#include "io/message.h"

namespace scancal {
namespace {

constexpr size_t kBlock = size_t{1} << 20;  // stays in the second-level cache
constexpr size_t kLongestLine = size_t{1} << 26;
constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

// Walks over a cell that starts with a quote, like SkipCell.
const char* SkipQuotedCell(const char* at) {
  bool quoted = false;  // a doubled quote leaves and enters again, which comes to the same
  for (; *at != '\n' && (quoted || *at != ','); ++at) {
    if (*at == '"') quoted = !quoted;
  }
  return at;
}

// From the start of a cell to the comma or the '\n' behind it.
inline const char* SkipCell(const char* at) {
  if (*at == '"') return SkipQuotedCell(at);
  while (*at != ',' && *at != '\n') ++at;
  return at;
}

const char* SkipBlanks(const char* at) {
  while (*at == ' ') ++at;
  return at;
}

std::string CellText(std::string_view cell) {
  const std::string_view quoted = WithoutBlanks(cell);
  if (quoted.size() < 2 || quoted.front() != '"' || quoted.back() != '"') return std::string(quoted);
  std::string text(WithoutBlanks(quoted.substr(1, quoted.size() - 2)));
  for (size_t at = text.find("\"\""); at != std::string::npos; at = text.find("\"\"", at + 1)) text.erase(at, 1);
  return text;
}

// From a comma behind the last cell: to the end of the line if nothing but such commas follows.
const char* SkipEmptyCells(const char* at) {
  const char* end = at;
  while (*end == ',' || *end == ' ' || *end == '\r') ++end;
  return *end == '\n' ? end : at;
}

// Blank, or a comment.
bool IsWithoutCells(std::string_view line) {
  const std::string_view text = WithoutBlanks(line);
  return text.empty() || (text.front() == '#' && !text.starts_with("#N/A"));
}

}  // namespace

bool CellIs(const std::string& cell, const std::string& value, const Dialect& dialect) {
  const ParsedNumber found = ParseNumber(cell), wanted = ParseNumber(value);
  if (found.kind == NumberKind::kNumber && wanted.kind == NumberKind::kNumber) return found.value == wanted.value;
  return dialect.Original(cell) == value;
}

TextLines::TextLines(DecodedFile file)
    : file_(std::move(file)),
      buffer_(kBlock + 1),
      begin_(buffer_.data()),
      end_(buffer_.data()),
      filled_end_(buffer_.data()) {}

Result<TextLines> TextLines::Open(const std::filesystem::path& path) {
  SCANCAL_ASSIGN_OR_RETURN(DecodedFile file, DecodedFile::Open(path));
  return Open(std::move(file));
}

Result<TextLines> TextLines::Open(DecodedFile file) {
  TextLines lines(std::move(file));
  SCANCAL_RETURN_IF_ERROR(lines.ReadMore());
  SCANCAL_RETURN_IF_ERROR(lines.CheckEncoding());
  return lines;
}

Result<void> TextLines::CheckEncoding() {
  const std::string_view text(begin_, static_cast<size_t>(filled_end_ - begin_));
  if (text.substr(0, 4096).find('\0') != std::string_view::npos) {
    return Error{name() + ": found binary data, expected text with commas", ErrorKind::kUnknownLayout};
  }
  const auto mark_size = static_cast<std::ptrdiff_t>(text.size() - WithoutByteOrderMark(text).size());
  begin_ += mark_size;
  end_ = std::max(begin_, end_);
  return {};
}

// Moves the unfinished line to the front and reads on behind it, until there is a whole line or the file ends.
Result<void> TextLines::ReadMore() {
  size_t filled = static_cast<size_t>(filled_end_ - begin_);
  std::memmove(buffer_.data(), begin_, filled);
  size_t whole = 0;
  while (whole == 0 && !at_end_) {
    if (filled + 1 == buffer_.size()) {
      if (filled > kLongestLine) return Error{name() + ": found a line of more than 64 MB, expected lines of text"};
      buffer_.resize(2 * buffer_.size());
    }
    const size_t room = buffer_.size() - 1 - filled;  // the last byte is kept for a line end that is missing
    SCANCAL_ASSIGN_OR_RETURN(const size_t count, file_.Read(buffer_.data() + filled, room));
    filled += count;
    at_end_ = count < room;
    if (at_end_ && filled > 0 && buffer_[filled - 1] != '\n') buffer_[filled++] = '\n';
    const std::string_view text(buffer_.data(), filled);
    whole = text.rfind('\n') + 1;  // npos + 1 is 0
  }
  begin_ = buffer_.data();
  end_ = begin_ + whole;
  filled_end_ = begin_ + filled;
  if (!dialect_.is_plain()) dialect_.Translate(buffer_.data(), buffer_.data() + whole);
  return {};
}

void TextLines::Translate(const Dialect& dialect) {
  dialect_ = dialect;
  char* const first = buffer_.data() + (begin_ - buffer_.data());
  if (!dialect_.is_plain()) dialect_.Translate(first, first + (end_ - begin_));
}

Result<bool> TextLines::Fill() {
  if (begin_ == end_ && !at_end_) SCANCAL_RETURN_IF_ERROR(ReadMore());
  return begin_ != end_;
}

Result<std::optional<std::string_view>> TextLines::TakeLine() {
  SCANCAL_ASSIGN_OR_RETURN(const bool filled, Fill());
  if (!filled) return std::optional<std::string_view>();
  const auto* const line_end = static_cast<const char*>(std::memchr(begin_, '\n', static_cast<size_t>(end_ - begin_)));
  const std::string_view line(begin_, static_cast<size_t>(line_end - begin_));
  begin_ = line_end + 1;
  return std::optional(line);
}

Result<DelimitedText> DelimitedText::Open(const std::filesystem::path& path) {
  SCANCAL_ASSIGN_OR_RETURN(TextLines text, TextLines::Open(path));
  return DelimitedText(std::move(text));
}

Result<DelimitedText> DelimitedText::Open(DecodedFile file) {
  SCANCAL_ASSIGN_OR_RETURN(TextLines text, TextLines::Open(std::move(file)));
  return DelimitedText(std::move(text));
}

// The lines that are in memory, enough of them to tell how the file is written.
std::vector<std::string_view> DelimitedText::FirstLines() const {
  constexpr size_t kMost = 1500;
  std::vector<std::string_view> lines;
  for (const char* at = text_.begin(); at != text_.end() && lines.size() < kMost;) {
    const auto* const end = static_cast<const char*>(std::memchr(at, '\n', static_cast<size_t>(text_.end() - at)));
    lines.emplace_back(at, end - at);
    at = end + 1;
  }
  return lines;
}

Result<TextHead> DelimitedText::TakeHead(const TextFormat& declared, const ColumnMatcher& match,
                                         const std::optional<NumberRows>& nameless) {
  const std::vector<std::string_view> lines = FirstLines();
  TextHead head;
  if (match) {
    SCANCAL_ASSIGN_OR_RETURN(head, FindHead(lines, declared, match, name()));
  }
  if (!head.is_known && nameless) {
    SCANCAL_ASSIGN_OR_RETURN(TextHead numbers, FindNumbers(lines, declared, *nameless, name()));
    // Names that are not the wanted ones: their columns may be others, too.
    const auto is_text = [](const std::string& name) { return ParseNumber(name).kind == NumberKind::kText; };
    const bool named = nameless->exactly && numbers.names.size() == nameless->cells &&
                       std::all_of(numbers.names.begin(), numbers.names.end(), is_text);
    if (named) numbers = {};
    if (numbers.is_known || !match) head = std::move(numbers);
    head.is_nameless = head.is_known;
  }
  TakeLines(head);
  return head;
}

void DelimitedText::TakeLines(const TextHead& head) {
  const std::vector<std::string_view> lines = FirstLines();
  head_ = head;
  const auto translated = [&](size_t line) {
    std::string text(lines[line - 1]);
    if (!head.dialect.is_plain()) head.dialect.Translate(text.data(), text.data() + text.size());
    return text;
  };
  if (head.is_known && head.names_line > 0 && !head.is_nameless) names_ = translated(head.names_line);
  if (!head.units.empty()) units_ = translated(head.lines);
  const size_t taken = std::min(head.lines, lines.size());
  if (taken > 0) text_.SkipTo(lines[taken - 1].data() + lines[taken - 1].size() + 1);
  line_ = static_cast<int64_t>(taken);
  line_start_ = lines.empty() ? nullptr : lines[std::max<size_t>(taken, 1) - 1].data();
  text_.Translate(head.dialect);
}

std::string DelimitedText::Describe() const {
  std::string text = text_.wrapping();
  const auto add = [&](const std::string& more) { text += (text.empty() || more.empty() ? "" : ", ") + more; };
  add(head_.dialect.Describe());
  if (head_.dialect.windows_1252) add("Windows-1252");
  if (head_.names_line > 1 && head_.is_known && !head_.is_nameless)
    add("names in line " + std::to_string(head_.names_line));
  if (!head_.units.empty()) add("units in line " + std::to_string(head_.lines));
  if (head_.is_nameless && head_.lines > 1) add("numbers from line " + std::to_string(head_.lines + 1) + " on");
  return text;
}

// The row in hand is not one that KeepWhere keeps.
bool DelimitedText::IsUnwanted() {
  const std::vector<std::string> cells = SplitCells(Line());
  const auto cell = [&](const auto& each) { return each.first < cells.size() ? cells[each.first] : std::string(); };
  const bool unwanted = std::any_of(where_.begin(), where_.end(), [&](const auto& each) {
    return each.first >= cells.size() || !CellIs(cell(each), each.second, head_.dialect);
  });
  if (!unwanted || !first_unwanted_.empty()) return unwanted;
  std::vector<std::string> found;
  for (const auto& each : where_) found.push_back(Quoted(head_.dialect.Original(cell(each))));
  first_unwanted_ = Listed(found);
  return true;
}

bool DelimitedText::IsHeadAgain() const {
  const std::string_view line = WithoutBlanks(Line());
  return !line.empty() && (line == WithoutBlanks(names_) || line == WithoutBlanks(units_));
}

void DelimitedText::Expect(std::vector<ExpectedCells> columns, std::vector<std::string> header, CellCount count) {
  columns_.assign(columns.size(), {});
  for (size_t k = 0; k < columns.size(); ++k) columns_[k].cells = columns[k].cells;
  columns_.back().behind = '\n';
  expected_ = std::move(columns);
  header_ = std::move(header);
  count_ = count;
}

void DelimitedText::KeepLines(int64_t first, int64_t last) {
  first_line_ = first;
  last_line_ = last;
}

// Walks over the lines that are no rows or unwanted.
Result<std::string_view> DelimitedText::Peek() {
  for (; line_ < last_line_; ++line_) {
    SCANCAL_ASSIGN_OR_RETURN(const bool filled, text_.Fill());
    if (!filled) break;
    line_start_ = text_.begin();
    if (line_ + 1 >= first_line_ && !IsWithoutCells(Line())) return Line();
    text_.SkipTo(Line().end() + 1);
  }
  return std::string_view();
}

void DelimitedText::Skip() {
  text_.SkipTo(Line().end() + 1);
  ++line_;
}

// Behind the last one, and like it; returns the last one.
DelimitedText::Column* DelimitedText::AddColumn() {
  columns_.push_back({columns_.back().cells, '\n', {}, nullptr, 0});
  Column* const last = &columns_.back() - 1;
  last->behind = ',';
  return last;
}

// A cell that is no plain number; nullptr if it is no number at all.
const char* DelimitedText::ReadCellCarefully(const char* at, Cells cells, double* number) const {
  const char* const end = SkipCell(SkipBlanks(at));
  const std::string_view cell(at, static_cast<size_t>(end - at));
  ParsedNumber parsed = ParseNumber(cell);
  if (parsed.kind == NumberKind::kText) {
    const auto is_it = [text = head_.dialect.Original(CellText(cell))](const std::string& missing) {
      return text == missing;
    };
    if (std::any_of(missing_.begin(), missing_.end(), is_it)) parsed.kind = NumberKind::kMissing;
    else if (const auto unquoted = head_.dialect.Unquoted(cell)) parsed = ParseNumber(*unquoted);
  }
  *number = parsed.kind == NumberKind::kMissing ? kNothing : parsed.value;
  const bool right =
      parsed.kind == NumberKind::kNumber || (parsed.kind == NumberKind::kMissing && cells == Cells::kNumberOrNothing);
  return right ? end : nullptr;
}

// `end`: of the block of lines.
inline const char* DelimitedText::ReadCell(const char* at, const char* end, Cells cells, ColumnParser& parser,
                                           double* number) const {
  const char* start = at;
  while (*start == ' ') ++start;
  if (const char* number_end = parser.Parse(start, end, number)) {
    if (*number_end == '\r') ++number_end;
    if (*number_end == ',' || *number_end == '\n') return number_end;
  }
  return ReadCellCarefully(at, cells, number);
}

Result<bool> DelimitedText::Next() {
  for (;;) {
    const char* at = text_.begin();
    // At a glance: nearly every row.
    if (at == text_.end() || *at <= ' ' || *at == '#' || line_ + 1 < first_line_ || line_ >= last_line_) {
      SCANCAL_ASSIGN_OR_RETURN(const std::string_view row, Peek());
      if (row.empty()) return false;
      at = row.data();
    }
    line_start_ = at;
    ++line_;
    if (!where_.empty() && IsUnwanted()) {
      text_.SkipTo(Line().end() + 1);
      continue;
    }
    const Column* wrong = nullptr;
    if (const char* const row_end = TakeCells(at, &wrong)) {
      text_.SkipTo(row_end + 1);
      return true;
    }
    if (!IsHeadAgain()) return Wrong(wrong);
    text_.SkipTo(Line().end() + 1);
  }
}

// Of the row that begins there; returns its '\n'. nullptr: one of them is wrong, or if none is their number.
inline const char* DelimitedText::TakeCells(const char* at, const Column** wrong) {
  const char* const end = text_.end();
  Column* column = columns_.data();
  for (;; ++column, ++at) {
    column->start = at;
    if (column->cells >= Cells::kNumber) {
      at = ReadCell(at, end, column->cells, column->parser, &column->number);
      if (at == nullptr) {
        *wrong = column;
        return nullptr;
      }
    } else {
      if (column->cells != Cells::kIgnored) at = SkipBlanks(at);
      const char* const start = at;
      at = SkipCell(start);
      // Any other first character stands for itself.
      const bool may_be_empty = column->cells == Cells::kText && *start <= ',';
      if (may_be_empty && CellText({start, at}).empty()) {
        *wrong = column;
        return nullptr;
      }
    }
    if (*at != column->behind) {
      if (*at == ',' && count_ != CellCount::kAny) at = SkipEmptyCells(at);
      if (*at != column->behind && count_ != CellCount::kAny) return nullptr;
      if (*at == ',') column = AddColumn();
    }
    if (*at == '\n') break;
  }
  cells_ = static_cast<size_t>(column - columns_.data()) + 1;
  return at;
}

std::string DelimitedText::Text(size_t column) const {
  const char* const start = columns_[column].start;
  const std::string text = CellText({start, SkipCell(SkipBlanks(start))});
  return head_.dialect.is_plain() && !head_.dialect.windows_1252 ? text : head_.dialect.Original(text);
}

size_t DelimitedText::Start(size_t column) {
  const char* const start = SkipBlanks(columns_[column].start);
  if (std::exchange(counted_line_, line_) != line_) {
    counted_ = line_start_;
    characters_ = 0;
  }
  characters_ += CountCharacters({counted_, start});
  counted_ = start;
  return 1 + characters_;
}

// The line in hand, without its end.
std::string_view DelimitedText::Line() const {
  return {line_start_,
          static_cast<const char*>(std::memchr(line_start_, '\n', static_cast<size_t>(text_.end() - line_start_)))};
}

// The row in hand has this wrong cell, or none but a wrong number of them.
Error DelimitedText::Wrong(const Column* column) {
  const size_t found = SplitCells(Line()).size();
  const bool is_text = column != nullptr && column->cells == Cells::kText;
  if (column != nullptr && (count_ != CellCount::kFirst || is_text || found == columns_.size())) {
    const auto k = static_cast<size_t>(column - columns_.data());
    const std::string& name = expected_[std::min(k, expected_.size() - 1)].name;
    const std::string place = Place() + ":" + std::to_string(Start(k)) + ": " + name + ": ";
    if (is_text) return Error{place + "the cell is empty, expected text"};
    const char* const start = SkipBlanks(column->start);
    const std::string_view cell = WithoutBlanks({start, SkipCell(start)});
    return Error{place + "found " + Quoted(head_.dialect.Original(cell)) + Expectation(ParseNumber(cell).kind) +
                 WrongSeparator()};
  }
  const std::string message = Place() + ": found " + std::to_string(found) + (found == 1 ? " cell" : " cells") +
                              ", expected " + std::to_string(columns_.size()) + " (" + Listed(header_) + ")";
  if (count_ == CellCount::kFirst) return Error{message + WrongSeparator()};
  return Error{message + (found < columns_.size() ? CutOff() : "")};
}

std::string DelimitedText::WrongSeparator() const {
  if (!head_.dialect.is_plain()) return "; found " + head_.dialect.Describe();
  const std::string_view line = Line();
  const auto has = [line](char c) { return line.find(c) != std::string_view::npos; };
  if (has(';')) return "; the cells are separated by semicolons, expected commas";
  if (WithoutBlanks(line).find('\r') != std::string_view::npos) {
    return "; the lines end with carriage returns alone, expected line feeds";
  }
  if (has('\t') && !has(',')) return "; the cells are separated by tabs, expected commas";
  return "";
}

std::string DelimitedText::CutOff() {
  text_.SkipTo(Line().end() + 1);
  const auto more = text_.Fill();
  return more.ok() && !*more ? "; the file is probably cut off here" : "";
}

}  // namespace scancal
