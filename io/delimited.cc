#include "io/delimited.h"
#include <algorithm>
#include <cstring>
#include <utility>
#include "io/message.h"

namespace scancal {
namespace {

constexpr size_t kBlock = size_t{1} << 20;  // stays in the second-level cache
constexpr size_t kLongestLine = size_t{1} << 26;

}  // namespace

TextLines::TextLines(InputFile file)
    : file_(std::move(file)),
      buffer_(kBlock + 1),
      begin_(buffer_.data()),
      end_(buffer_.data()),
      filled_end_(buffer_.data()) {}

Result<TextLines> TextLines::Open(const std::filesystem::path& path) {
  SCANCAL_ASSIGN_OR_RETURN(InputFile file, InputFile::Open(path));
  TextLines lines(std::move(file));
  SCANCAL_RETURN_IF_ERROR(lines.ReadMore());
  SCANCAL_RETURN_IF_ERROR(lines.CheckEncoding());
  return lines;
}

Result<void> TextLines::CheckEncoding() {
  const std::string_view text(begin_, static_cast<size_t>(filled_end_ - begin_));
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    return Error{name() + ": found UTF-16 text, expected UTF-8; save the file as UTF-8 or plain text"};
  }
  if (text.substr(0, 4096).find('\0') != std::string_view::npos) {
    return Error{name() + ": found binary data, expected text with commas"};
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
    bytes_read_ += static_cast<int64_t>(count);
    filled += count;
    at_end_ = count < room;
    if (at_end_ && filled > 0 && buffer_[filled - 1] != '\n') buffer_[filled++] = '\n';
    const std::string_view text(buffer_.data(), filled);
    whole = text.rfind('\n') + 1;  // npos + 1 is 0
  }
  begin_ = buffer_.data();
  end_ = begin_ + whole;
  filled_end_ = begin_ + filled;
  return {};
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

const char* SkipQuotedCell(const char* at) {
  bool quoted = false;  // a doubled quote leaves and enters again, which comes to the same
  for (; *at != '\n' && (quoted || *at != ','); ++at) {
    if (*at == '"') quoted = !quoted;
  }
  return at;
}

const char* ReadCellCarefully(const char* at, ParsedNumber* number) {
  const char* start = at;
  while (*start == ' ') ++start;
  const char* const end = SkipCell(start);
  *number = ParseNumber(std::string_view(at, static_cast<size_t>(end - at)));
  return end;
}

std::string CellText(std::string_view cell) {
  const std::string_view quoted = WithoutBlanks(cell);
  if (quoted.size() < 2 || quoted.front() != '"' || quoted.back() != '"') return std::string(quoted);
  std::string text(WithoutBlanks(quoted.substr(1, quoted.size() - 2)));
  for (size_t at = text.find("\"\""); at != std::string::npos; at = text.find("\"\"", at + 1)) text.erase(at, 1);
  return text;
}

std::vector<CsvField> SplitCells(std::string_view line) {
  const std::string ended = std::string(line) + '\n';
  const char* const line_start = ended.c_str();
  const char* const line_end = line_start + line.size();
  std::vector<CsvField> fields;
  for (const char* at = line_start;; ++at) {
    while (*at == ' ') ++at;
    const char* const end = SkipCell(at);
    const std::string_view before(line_start, static_cast<size_t>(at - line_start));
    fields.push_back({.text = CellText({at, end}), .column = 1 + CountCharacters(before)});
    at = end;
    if (at == line_end) return fields;
  }
}

Error WrongCsvCell(const std::string& place, std::string_view line, const char* cell, const std::string& name,
                   NumberKind kind) {
  while (*cell == ' ') ++cell;
  const auto size = static_cast<size_t>(SkipCell(cell) - cell);
  const size_t column = 1 + CountCharacters(line.substr(0, static_cast<size_t>(cell - line.data())));
  return Error{place + ":" + std::to_string(column) + ": " + name + ": found " +
               Quoted(WithoutBlanks(std::string_view(cell, size))) + Expectation(kind) + WrongSeparator(line)};
}

bool IsWithoutCells(std::string_view line) {
  const std::string_view text = WithoutBlanks(line);
  return text.empty() || text.front() == '#';
}

std::string WrongSeparator(std::string_view line) {
  const auto has = [line](char c) { return line.find(c) != std::string_view::npos; };
  if (has(';')) return "; the cells are separated by semicolons, expected commas";
  if (WithoutBlanks(line).find('\r') != std::string_view::npos) {
    return "; the lines end with carriage returns alone, expected line feeds";
  }
  if (has('\t') && !has(',')) return "; the cells are separated by tabs, expected commas";
  return "";
}

}  // namespace scancal
