#include "io/dialect.h"
#include <algorithm>
#include <cctype>
#include <numeric>
#include <utility>
#include "io/message.h"
#include "io/number.h"
#include "io/units.h"

namespace scancal {
namespace {

constexpr char kSeparators[] = {',', ';', '\t', ' '};
constexpr size_t kRowsForDecimal = 200;
constexpr size_t kMostLinesOfHead = 1000;

bool IsBlank(char c) { return c == ' ' || c == '\t'; }
bool IsDigit(char c) { return c >= '0' && c <= '9'; }

const char* Name(char separator) {
  return separator == ';' ? "semicolons" : separator == '\t' ? "tabs" : separator == ' ' ? "blanks" : "commas";
}

// Blank, or a comment; "#N/A" begins no comment.
bool HasCells(std::string_view line) {
  const std::string_view text = WithoutBlanks(line);
  return !text.empty() && (text.front() != '#' || text.starts_with("#N/A"));
}

std::string Unquote(std::string_view cell) {
  const std::string_view quoted = WithoutBlanks(cell);
  if (quoted.size() < 2 || quoted.front() != '"' || quoted.back() != '"') return std::string(quoted);
  std::string text(WithoutBlanks(quoted.substr(1, quoted.size() - 2)));
  for (size_t at = text.find("\"\""); at != std::string::npos; at = text.find("\"\"", at + 1)) text.erase(at, 1);
  return text;
}

// As they stand there; a separator in quotes is none, and a quote opens them only where a cell begins. Blanks: any
// number of them separates.
std::vector<std::string_view> RawCells(std::string_view line, char separator) {
  const bool blanks = separator == ' ';
  std::vector<std::string_view> cells;
  size_t at = 0;
  const auto skip_blanks = [&] {
    while (at < line.size() && (blanks ? IsBlank(line[at]) || line[at] == '\r' : line[at] == ' ')) ++at;
  };
  for (;;) {
    skip_blanks();
    const size_t start = at;
    bool quoted = false;
    const bool may_quote = at < line.size() && line[at] == '"';
    for (; at < line.size(); ++at) {
      if (may_quote && line[at] == '"') quoted = !quoted;
      if (!quoted && (blanks ? IsBlank(line[at]) : line[at] == separator)) break;
    }
    if (!blanks || at > start) cells.push_back(line.substr(start, at - start));
    if (at >= line.size()) return cells;
    ++at;
  }
}

void DropTrailing(std::vector<std::string>* cells) {
  while (cells->size() > 1 && cells->back().empty()) cells->pop_back();
}

std::string FromWindows1252(std::string_view text) {
  // Of 0x80 to 0x9F; the others are as in Unicode.
  static constexpr uint16_t kSpecial[] = {0x20AC, 0xFFFD, 0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021,
                                          0x02C6, 0x2030, 0x0160, 0x2039, 0x0152, 0xFFFD, 0x017D, 0xFFFD,
                                          0xFFFD, 0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014,
                                          0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0xFFFD, 0x017E, 0x0178};
  std::string utf8;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const unsigned u = byte >= 0x80 && byte < 0xA0 ? kSpecial[byte - 0x80U] : byte;
    if (u < 0x80) utf8 += c;
    else if (u < 0x800) utf8 += {static_cast<char>(0xC0U | u >> 6U), static_cast<char>(0x80U | (u & 0x3FU))};
    else
      utf8 += {static_cast<char>(0xE0U | u >> 12U), static_cast<char>(0x80U | (u >> 6U & 0x3FU)),
               static_cast<char>(0x80U | (u & 0x3FU))};
  }
  return utf8;
}

// "Angle", "[deg]" are one name.
std::vector<std::string> WithUnits(std::vector<std::string> names) {
  std::vector<std::string> joined;
  for (std::string& name : names) {
    const bool unit = !joined.empty() && !name.empty() && (name.front() == '[' || name.front() == '(');
    if (unit) joined.back() += " " + name;
    else joined.push_back(std::move(name));
  }
  return joined;
}

// With a decimal comma a point is none.
bool IsNumber(std::string_view raw, char decimal) {
  std::string cell = Unquote(raw);
  if (decimal == ',') {
    if (cell.find('.') != std::string::npos && ParseNumber(cell).kind == NumberKind::kNumber) return false;
    std::replace(cell.begin(), cell.end(), ',', '.');
  }
  const NumberKind kind = ParseNumber(cell).kind;
  return kind == NumberKind::kNumber || kind == NumberKind::kMissing;
}

std::vector<char> SeparatorsOf(const TextFormat& declared, const std::vector<std::string_view>& lines) {
  if (declared.separator) return {*declared.separator};
  if (!lines.empty()) {
    const std::string_view first = WithoutBlanks(WithoutByteOrderMark(lines[0]));
    if (first.size() == 5 && first.starts_with("sep=")) return {first[4]};
    if (WithoutByteOrderMark(lines[0]).starts_with("sep=\t")) return {'\t'};
  }
  return {std::begin(kSeparators), std::end(kSeparators)};
}

bool IsSeparatorLine(std::string_view line) { return WithoutByteOrderMark(line).starts_with("sep="); }

// A row of nothing but units; what is no length nor angle may have any short unit.
bool AreUnits(const std::vector<std::string>& cells) {
  bool any = false;
  for (std::string cell : cells) {
    if (cell.size() >= 2 && (cell.front() == '[' || cell.front() == '(')) cell = cell.substr(1, cell.size() - 2);
    if (HeaderUnit(cell, Dimension::kLength) || HeaderUnit(cell, Dimension::kAngle)) any = true;
    else if (cell.size() > 6 || (!cell.empty() && ParseNumber(cell).kind == NumberKind::kNumber)) return false;
  }
  return any;
}

std::string Joined(const std::vector<std::string>& cells) {
  return std::accumulate(
      cells.begin(), cells.end(), std::string(),
      [](const std::string& all, const std::string& cell) { return all.empty() ? cell : all + " | " + cell; });
}

class HeadFinder {
 public:
  HeadFinder(const std::vector<std::string_view>& lines, const TextFormat& declared, const std::string& file)
      : lines_(lines), declared_(declared), file_(file) {}

  // Below the head: the decimal sign in these columns, of rows of `names` cells.
  Result<void> FindDecimal(TextHead* head, const std::vector<size_t>& columns, size_t names) const {
    Dialect& dialect = head->dialect;
    if (declared_.decimal) dialect.decimal = *declared_.decimal;
    if (dialect.separator == ',') return OfCommas(head, columns, names);
    std::string comma, point;
    for (size_t i = head->lines, rows = 0; i < lines_.size() && rows < kRowsForDecimal; ++i) {
      if (!HasCells(lines_[i])) continue;
      ++rows;
      const std::vector<std::string_view> cells = RawCells(lines_[i], dialect.separator);
      for (const size_t k : columns) {
        if (k >= cells.size()) continue;
        const std::string cell = Unquote(cells[k]);
        if (cell.empty() || cell.find_first_of("0123456789") == std::string::npos) continue;
        const size_t last = cell.find_last_of(",.");
        if (last != std::string::npos) (cell[last] == ',' ? comma : point) = cell;
      }
    }
    if (declared_.decimal) return {};
    if (!comma.empty() && !point.empty())
      return Error{file_ + ": found " + Quoted(comma) + " and " + Quoted(point) +
                   ": which of them has the decimal sign? say text: {decimal: \",\"} or text: {decimal: \".\"}"};
    dialect.decimal = comma.empty() ? '.' : ',';
    return {};
  }

 private:
  // Cells between commas: a comma in a number is in quotes, or the file reads in two ways.
  Result<void> OfCommas(TextHead* head, const std::vector<size_t>& columns, size_t names) const {
    std::string thousands, decimal, either;
    for (size_t i = head->lines, rows = 0; i < lines_.size() && rows < kRowsForDecimal; ++i) {
      if (!HasCells(lines_[i])) continue;
      ++rows;
      std::vector<std::string> cells = SplitCells(lines_[i]);
      DropTrailing(&cells);
      if (cells.size() == 2 * names && ReadsTwice(cells)) return TwoReadings(i, cells, names);
      if (cells.size() != names) continue;
      for (const size_t k : columns)
        if (k < cells.size() && cells[k].find(',') != std::string::npos)
          *Meaning(cells[k], &thousands, &decimal, &either) = cells[k];
    }
    Dialect& dialect = head->dialect;
    dialect.decimal = '.';
    if (declared_.decimal) {
      dialect.quoted = *declared_.decimal == ',' ? QuotedCommas::kDecimal : QuotedCommas::kThousands;
      return {};
    }
    if (!thousands.empty() && !decimal.empty())
      return Error{file_ + ": found " + Quoted(thousands) + " and " + Quoted(decimal) +
                   ": is the comma a decimal sign or does it separate thousands? say text: {decimal: \",\"} or text: "
                   "{decimal: \".\"}"};
    if (!either.empty() && thousands.empty() && decimal.empty()) {
      std::string point = either, none = either;
      std::replace(point.begin(), point.end(), ',', '.');
      std::erase(none, ',');
      return Error{file_ + ": found " + Quoted(either) + ": is it " + point + " or " + none +
                   "? say text: {decimal: \",\"} or text: {decimal: \".\"}"};
    }
    if (!thousands.empty()) dialect.quoted = QuotedCommas::kThousands;
    if (!decimal.empty()) dialect.quoted = QuotedCommas::kDecimal;
    return {};
  }

  static std::string* Meaning(const std::string& cell, std::string* thousands, std::string* decimal,
                              std::string* either) {
    const size_t comma = cell.find(','), digits = cell.find_first_of("0123456789");
    if (cell.find('.') != std::string::npos || cell.find(',', comma + 1) != std::string::npos) return thousands;
    size_t behind = comma + 1;
    while (behind < cell.size() && IsDigit(cell[behind])) ++behind;
    const bool groups =
        behind - comma == 4 && behind == cell.size() && comma - digits <= 3 && comma > digits && cell[digits] != '0';
    return groups ? either : decimal;
  }

  // Whole numbers only, where there are more of them than names.
  static bool ReadsTwice(const std::vector<std::string>& cells) {
    return std::all_of(cells.begin(), cells.end(), [](const std::string& cell) {
      return !cell.empty() && std::all_of(cell.begin() + (cell[0] == '-' ? 1 : 0), cell.end(), IsDigit);
    });
  }

  Error TwoReadings(size_t line, const std::vector<std::string>& cells, size_t names) const {
    std::vector<std::string> pairs;
    for (size_t k = 0; k + 1 < cells.size(); k += 2) pairs.push_back(cells[k] + "." + cells[k + 1]);
    const std::string place = file_ + ":" + std::to_string(line + 1) + ": ";
    const std::string found =
        "found " + std::to_string(cells.size()) + " cells under " + std::to_string(names) + " names: ";
    return {place + found + "with decimal commas it is " +
            (2 * names == cells.size() ? Joined(pairs) : "another number of cells") +
            ", with commas between the cells " + Joined(cells) +
            "; save it with decimal points, or with semicolons between the cells"};
  }

  const std::vector<std::string_view>& lines_;
  const TextFormat& declared_;
  const std::string& file_;
};

std::vector<std::string> NamesIn(std::string_view line, char separator, bool windows_1252) {
  std::vector<std::string> names = SplitCells(WithoutByteOrderMark(line), separator);
  DropTrailing(&names);
  if (separator == ' ') names = WithUnits(std::move(names));
  for (std::string& name : names)
    if (windows_1252 && FirstInvalidUtf8(name)) name = FromWindows1252(name);
  return names;
}

bool IsWindows1252(const std::vector<std::string_view>& lines, const TextFormat& declared) {
  return declared.windows_1252.value_or(std::any_of(
      lines.begin(), lines.end(), [](std::string_view line) { return FirstInvalidUtf8(line).has_value(); }));
}

bool PassesAs(std::string_view line, char separator, char decimal, const NumberRows& rows) {
  std::vector<std::string_view> cells = RawCells(line, separator);
  while (cells.size() > rows.cells && WithoutBlanks(cells.back()).empty()) cells.pop_back();
  if (rows.exactly ? cells.size() != rows.cells : cells.size() < rows.cells) return false;
  bool any = false;
  const auto take = [&](size_t k) {
    any |= !WithoutBlanks(cells[k]).empty();
    return IsNumber(cells[k], decimal);
  };
  for (const size_t k : rows.numbers)
    if (!take(k)) return false;
  for (size_t k = rows.cells - 1; !rows.exactly && k < cells.size(); ++k)
    if (!take(k)) return false;
  return any;
}

// Begins with a number, or has many cells and some numbers among them; quotes do not count.
bool LooksLikeRow(std::string_view line, char separator, size_t cells) {
  size_t count = 0, numbers = 0;
  bool first = false;
  for (size_t at = 0; at <= line.size(); ++count) {
    const size_t end = std::min(line.find(separator, at), line.size());
    const std::string_view cell = WithoutBlanks(line.substr(at, end - at));
    const bool is_number = !cell.empty() && (IsDigit(cell[0]) || cell[0] == '-' || cell[0] == '+' || cell[0] == '.');
    numbers += is_number ? 1 : 0;
    if (count == 0) first = is_number;
    at = end + 1;
  }
  return first || (count >= cells && numbers >= 2);
}

}  // namespace

std::vector<std::string> SplitCells(std::string_view line, char separator) {
  std::vector<std::string> cells;
  for (const std::string_view cell : RawCells(line, separator)) cells.push_back(Unquote(cell));
  if (cells.empty()) cells.emplace_back();
  return cells;
}

Result<TextHead> FindHead(const std::vector<std::string_view>& lines, const TextFormat& declared,
                          const ColumnMatcher& match, const std::string& file) {
  TextHead head;
  head.dialect.windows_1252 = IsWindows1252(lines, declared);
  const std::vector<char> separators = SeparatorsOf(declared, lines);
  const size_t most =
      std::min({lines.size(), kMostLinesOfHead, static_cast<size_t>(declared.header_lines.value_or(kMostLinesOfHead))});
  std::vector<size_t> columns;
  // A commented line of names (numpy.savetxt) is one if no other is.
  for (const bool comments : {false, true}) {
    for (size_t i = 0; i < most && columns.empty(); ++i) {
      if (HasCells(lines[i]) == comments || IsSeparatorLine(lines[i])) continue;
      std::string_view line = WithoutBlanks(lines[i]);
      while (comments && line.starts_with('#')) line = WithoutBlanks(line.substr(1));
      if (line.empty()) continue;
      for (const char separator : separators) {
        std::vector<std::string> names = NamesIn(comments ? line : lines[i], separator, head.dialect.windows_1252);
        std::vector<size_t> found = match(names);
        if (found.empty() || (!columns.empty() && found.size() <= columns.size())) continue;
        columns = std::move(found);
        head.names = std::move(names);
        head.dialect.separator = separator;
        head.names_line = i + 1;
      }
    }
    if (!columns.empty()) break;
  }
  head.is_known = !columns.empty();
  if (!head.is_known) {
    // The row above the first numbers looks most like names.
    const std::vector<char> all(separators);
    size_t above = lines.size(), last = lines.size();
    for (size_t i = 0; i < most && above == lines.size(); ++i) {
      if (!HasCells(lines[i]) || IsSeparatorLine(lines[i])) continue;
      for (const char separator : all)
        for (const char decimal : {'.', ','}) {
          const NumberRows two{2, false, {0}};
          if (above == lines.size() && PassesAs(lines[i], separator, decimal, two)) {
            head.dialect.separator = separator;
            above = last < lines.size() ? last : i;
          }
        }
      last = i;
    }
    for (size_t i = 0; i < lines.size() && above == lines.size(); ++i)
      if (HasCells(lines[i]) && !IsSeparatorLine(lines[i])) {
        above = i;
        head.dialect.separator = separators.front();
      }
    if (above == lines.size()) return head;
    head.names = NamesIn(lines[above], head.dialect.separator, head.dialect.windows_1252);
    head.names_line = above + 1;
    head.lines = head.names_line;
    return head;
  }
  head.lines = head.names_line;
  while (head.lines < lines.size() && !HasCells(lines[head.lines])) ++head.lines;
  if (head.lines < lines.size()) {
    std::vector<std::string> units = NamesIn(lines[head.lines], head.dialect.separator, head.dialect.windows_1252);
    if (units.size() <= head.names.size() && AreUnits(units)) {
      units.resize(head.names.size());
      head.units = std::move(units);
      ++head.lines;
    }
  }
  if (declared.header_lines) head.lines = static_cast<size_t>(*declared.header_lines);
  SCANCAL_RETURN_IF_ERROR(HeadFinder(lines, declared, file).FindDecimal(&head, columns, head.names.size()));
  return head;
}

Result<TextHead> FindNumbers(const std::vector<std::string_view>& lines, const TextFormat& declared,
                             const NumberRows& rows, const std::string& file) {
  TextHead head;
  head.dialect.windows_1252 = IsWindows1252(lines, declared);
  size_t best = 0;
  const size_t begin = static_cast<size_t>(declared.header_lines.value_or(0));
  for (const char separator : SeparatorsOf(declared, lines))
    for (const char decimal : {'.', ','}) {
      if ((separator == ',' && decimal == ',') || declared.decimal.value_or(decimal) != decimal) continue;
      size_t passed = 0, first = 0;
      for (size_t i = begin; i < std::min(lines.size(), kMostLinesOfHead); ++i) {
        if (!HasCells(lines[i]) || !PassesAs(lines[i], separator, decimal, rows)) continue;
        if (++passed == 1) first = i;
      }
      if (passed <= best) continue;
      best = passed;
      head.dialect.separator = separator;
      head.dialect.decimal = decimal;
      head.lines = first;
      head.is_known = true;
    }
  if (head.is_known) {
    // What looks like a row is no text above the data: a wrong one is to be told, not left out.
    for (size_t i = head.lines; i > begin; --i)
      if (HasCells(lines[i - 1]) && LooksLikeRow(lines[i - 1], head.dialect.separator, rows.cells)) head.lines = i - 1;
    for (size_t i = head.lines; i > 0 && head.names.empty(); --i)
      if (HasCells(lines[i - 1]) && !IsSeparatorLine(lines[i - 1])) {
        head.names = NamesIn(lines[i - 1], head.dialect.separator, head.dialect.windows_1252);
        head.names_line = i;
      }
    return head;
  }
  // Whole numbers between commas, more than there are columns: is every second one a fraction?
  const auto numbers = [](std::string_view line) { return PassesAs(line, ',', '.', {2, false, {0}}); };
  const auto row = std::find_if(lines.begin(), lines.end(), numbers);
  if (row == lines.end() || !rows.exactly) return head;
  head.lines = static_cast<size_t>(row - lines.begin());
  SCANCAL_RETURN_IF_ERROR(HeadFinder(lines, declared, file).FindDecimal(&head, {}, rows.cells));
  return head;
}

void Dialect::Translate(char* begin, char* end) const {
  // A sign that is neither separator nor decimal takes the place of what it would be mistaken for.
  const char other = separator == ' ' ? ';' : separator;
  std::array<char, 256> to;
  for (size_t c = 0; c < to.size(); ++c) to[c] = static_cast<char>(c);
  const auto byte = [](char c) { return static_cast<unsigned char>(c); };
  to[byte(',')] = decimal == ',' ? '.' : other;
  if (decimal == ',') to[byte('.')] = other;
  if (separator != ' ') {
    to[byte(separator)] = ',';
    for (char* at = begin; at != end; ++at) *at = to[byte(*at)];
    return;
  }
  to[byte(';')] = '\t';  // which is no cell's own
  bool quoted = false, in_cell = false;
  for (char* at = begin; at != end; ++at) {
    if (*at == '"') quoted = !quoted;
    if (*at == '\n' || *at == '\r') {
      quoted = in_cell = false;
    } else if (!IsBlank(*at) || quoted) {
      *at = to[byte(*at)];
      in_cell = true;
    } else {
      const char* next = at;
      while (in_cell && next != end && IsBlank(*next)) ++next;
      *at = std::exchange(in_cell, false) && next != end && *next != '\n' && *next != '\r' ? ',' : ' ';
    }
  }
}

std::string Dialect::Original(std::string_view text) const {
  std::string original(text);
  const char group = separator == ' ' ? ';' : separator;  // where the other sign went
  if (separator != ',')
    for (char& c : original) {
      if (c == ',') c = separator;
      else if (c == '.' && decimal == ',') c = ',';
      else if (c == group) c = decimal == ',' ? '.' : ',';
      else if (c == '\t') c = ';';
    }
  return FirstInvalidUtf8(original) ? FromWindows1252(original) : original;
}

std::optional<std::string> Dialect::Unquoted(std::string_view cell) const {
  std::string_view text = WithoutBlanks(cell);
  if (text.size() < 3 || text.front() != '"' || text.back() != '"') return std::nullopt;
  text = WithoutBlanks(text.substr(1, text.size() - 2));
  const char group = separator == ',' ? ',' : separator == ' ' ? ';' : separator;
  std::string plain(text);
  if (separator == ',' && quoted == QuotedCommas::kDecimal) {
    std::replace(plain.begin(), plain.end(), ',', '.');
    return plain;
  }
  // [-+]ddd(,ddd)+[.d*]
  size_t at = text.find_first_of("0123456789"), groups = 0;
  if (at == std::string_view::npos || at > 1) return std::nullopt;
  const size_t first = at;
  while (at < text.size() && IsDigit(text[at])) ++at;
  if (at - first > 3) return std::nullopt;
  while (at + 3 < text.size() && text[at] == group &&
         std::all_of(text.begin() + at + 1, text.begin() + at + 4, IsDigit)) {
    at += 4;
    ++groups;
  }
  const bool ends = at == text.size() || text[at] == '.';
  const bool sure = groups > 1 || at < text.size() || separator != ',' || quoted == QuotedCommas::kThousands;
  if (groups == 0 || !ends || !sure) return std::nullopt;
  std::erase(plain, group);
  return plain;
}

std::string Dialect::Describe() const {
  std::string text;
  if (separator != ',') text = std::string("cells between ") + scancal::Name(separator);
  if (decimal == ',' || quoted == QuotedCommas::kDecimal)
    text += (text.empty() ? "" : ", ") + std::string("decimal commas");
  if (quoted == QuotedCommas::kThousands) text += (text.empty() ? "" : ", ") + std::string("commas between thousands");
  return text;
}

}  // namespace scancal
