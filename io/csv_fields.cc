#include "io/csv_fields.h"
#include "io/message.h"
#include "io/scan_source.h"
#include "io/utf8.h"

namespace scancal {

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
  Error error =
      WrongCell(place + ":" + std::to_string(column), name, kind, Quoted(WithoutBlanks(std::string_view(cell, size))));
  error.message += WrongSeparator(line);
  return error;
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
