#include "report/text.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include "solver/uncertainty/gum.h"

namespace scancal {
namespace {

// Columns on a terminal: bytes that continue a UTF-8 character take none.
size_t Width(const std::string& text) {
  return static_cast<size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

// Without the sign of a zero.
std::string Fixed(double value, int decimals) {
  const std::string text = fmt::format("{:.{}f}", value, decimals);
  return text.find_first_of("123456789") == std::string::npos && text[0] == '-' ? text.substr(1) : text;
}

std::string NotANumber(double value) { return std::isnan(value) ? "-" : value > 0 ? "infinite" : "-infinite"; }

}  // namespace

TextTable::TextTable(std::vector<std::string> header) { rows_.push_back(std::move(header)); }

void TextTable::Add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }

std::string TextTable::Text() const {
  std::vector<size_t> widths(rows_.front().size(), 0);
  for (const auto& row : rows_)
    for (size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], Width(row[c]));
  std::string text;
  for (size_t r = 0; r < rows_.size(); ++r) {
    std::string line;
    for (size_t c = 0; c < rows_[r].size(); ++c) {
      const std::string blank(widths[c] - Width(rows_[r][c]), ' ');
      line += (c ? "  " : "") + (c ? blank + rows_[r][c] : rows_[r][c] + blank);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
    if (r > 0) continue;
    size_t all = 2 * (widths.size() - 1);
    for (const size_t width : widths) all += width;
    text += std::string(all, '-') + "\n";
  }
  return text;
}

std::string Count(double number) { return std::isfinite(number) ? Fixed(number, 0) : "infinite"; }

std::string Significant(double value, int digits) {
  if (!std::isfinite(value)) return NotANumber(value);
  if (value == 0) return Fixed(0, digits - 1);
  // The exponent after rounding: 0.0999 to two digits is 0.10.
  std::string scientific = fmt::format("{:.{}e}", value, digits - 1);
  const int exponent = std::stoi(scientific.substr(scientific.find('e') + 1));
  if (std::abs(value) < 1e-4 || std::abs(value) >= 1e6) return scientific;
  return Fixed(value, std::max(0, digits - 1 - exponent));
}

std::string Concise(double value, double u) {
  if (!std::isfinite(value) || !std::isfinite(u) || !(u > 0)) return Significant(value, 6);
  // Two digits of u; 0.0996 rounds to 0.10, which shifts the last place by one.
  int last = static_cast<int>(std::floor(std::log10(u))) - 1;
  if (std::round(u / std::pow(10, last)) >= 100) ++last;
  if (last >= 0) return Fixed(value, 0) + "(" + Fixed(u, 0) + ")";
  return Fixed(value, -last) + "(" + Fixed(u / std::pow(10, last), 0) + ")";
}

std::string Wrapped(const std::string& text, size_t columns) {
  std::string wrapped;
  for (size_t from = 0; from < text.size();) {
    const size_t end = std::min(text.find('\n', from), text.size());
    std::string line = text.substr(from, end - from);
    from = end + 1;
    const bool of_table = line.find("  ") != std::string::npos || line.starts_with("----");
    for (std::string indent; !of_table && Width(line) > columns; indent = "  ") {
      size_t blank = std::string::npos;
      for (size_t at = line.find(' ', indent.size()); at != std::string::npos; at = line.find(' ', at + 1)) {
        if (Width(line.substr(0, at)) > columns && blank != std::string::npos) break;
        blank = at;
      }
      if (blank == std::string::npos) break;
      wrapped += line.substr(0, blank) + "\n";
      line = "  " + line.substr(blank + 1);
    }
    wrapped += line + "\n";
  }
  return wrapped;
}

std::string CoverageText() { return fmt::format("{:g} %", 100 * kCoverage); }

}  // namespace scancal
