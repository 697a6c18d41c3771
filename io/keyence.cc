// Text that programs of Keyence's profilers save: profiles of an LJ-V7000 (Communication Library Reference Manual,
// "Save file format"), heights of an LJ-X8000.
#include <algorithm>
#include <cmath>
#include <utility>
#include "io/file_kind.h"
#include "io/number.h"

namespace scancal {
namespace {

constexpr double kLjVUnit_mm = 1e-5;         // 0.01 um
constexpr double kLjVInvalid = -2147483648;  // 0x80000000, and the three that follow: why nothing was measured there
constexpr double kLjXZero = 32768;
constexpr std::string_view kLjXInvalid = "-99999.9999";

std::optional<double> WholeNumber(std::string_view cell) {
  const ParsedNumber number = ParseNumber(cell);
  const bool whole = number.kind == NumberKind::kNumber && std::floor(number.value) == number.value;
  return whole && cell.find_first_of(".eE\"") == std::string_view::npos ? std::optional(number.value) : std::nullopt;
}

// Whole numbers between tabs, the first of each line in even steps, and no names.
bool IsLjV(std::string_view start, const ScanFormat& format) {
  if (format.layout || !format.npy_columns.empty()) return false;
  std::vector<double> x;
  while (x.size() < 20 && start.find('\n') != std::string_view::npos) {
    std::string_view line = TakeFirstLine(&start);
    size_t cells = 0;
    for (; !line.empty(); ++cells) {
      const std::string_view cell = line.substr(0, line.find('\t'));
      const auto number = WholeNumber(cell);
      if (!number) return false;
      if (cells == 0) x.push_back(*number);
      line.remove_prefix(std::min(line.size(), cell.size() + 1));
    }
    if (cells < 2) return false;
  }
  if (x.size() < 3 || x[1] == x[0]) return false;
  for (size_t k = 2; k < x.size(); ++k)
    if (x[k] - x[k - 1] != x[1] - x[0]) return false;
  return true;
}

// X in the first column, a profile a column; all in whole numbers of 0.01 um.
Result<std::unique_ptr<ScanReader>> OpenLjV(const ScanFormat& format) {
  SCANCAL_ASSIGN_OR_RETURN(const std::string start, FirstBytes(format.path, 4096));
  if (start.find('\t') == std::string::npos && start.find_first_of(",;") != std::string::npos)
    return Error{format.path.string() +
                 ": found no tabs, expected profiles of a Keyence LJ-V: whole numbers between tabs, X first"};
  ScanFormat file = format;
  file.units.length_in_mm = kLjVUnit_mm;
  file.text.separator = '\t';
  file.layout = WideLayout{.value = "y", .across = "z", .tall = true};
  file.layout->heights = true;
  file.layout->echo = "Keyence LJ-V: X and a profile a column in 0.01 um, -2147483648 to -2147483645 missing";
  for (int k = 0; k < 4; ++k) file.more_invalid.push_back(kLjVInvalid + k);
  return OpenWideCsv(file);
}

bool IsLjX(std::string_view start, const ScanFormat& format) {
  if (!format.layout || !format.layout->image) return false;
  const std::string_view first = TakeFirstLine(&start);
  const std::string_view cell = first.substr(0, first.find(','));
  const bool numbers = first.size() > cell.size() && ParseNumber(cell).kind == NumberKind::kNumber;
  return numbers &&
         (first.find(kLjXInvalid) != std::string_view::npos || start.find(kLjXInvalid) != std::string_view::npos);
}

// Height = (v - 32768) scale + offset, 0 where nothing was measured.
Result<std::unique_ptr<ScanReader>> OpenLjXImage(const ScanFormat& format) {
  ScanFormat file = format;
  file.layout->offset -= kLjXZero * file.layout->scale;
  file.layout->heights = true;
  file.layout->echo = "Keyence LJ-X heights, 32768 is 0, 0 missing";
  file.more_invalid.push_back(0);
  return kHeightImage.open(file);
}

// A profile a row, in mm.
Result<std::unique_ptr<ScanReader>> OpenLjX(const ScanFormat& format) {
  if (!format.layout || !format.layout->image)
    return Error{format.path.string() +
                 ": the heights of a Keyence LJ-X say nothing of their places, expected layout: {image: y, start: ..., "
                 "step: ...}, along the line"};
  SCANCAL_ASSIGN_OR_RETURN(const std::string start, FirstBytes(format.path, 16));
  if (StartsAsImage(start)) return OpenLjXImage(format);
  ScanFormat file = format;
  const double unit = std::exchange(file.units.length_in_mm, 1);
  file.layout->start *= unit;
  file.layout->step *= unit;
  file.layout->heights = true;
  file.layout->echo = "Keyence LJ-X heights in mm, " + std::string(kLjXInvalid) + " missing";
  file.more_invalid.push_back(ParseNumber(kLjXInvalid).value);
  return OpenWideCsv(file);
}

}  // namespace

const FileKind kLjV = {"lj-v", "Keyence LJ-V profiles", &IsLjV, &OpenLjV};
const FileKind kLjX = {"lj-x", "Keyence LJ-X heights", &IsLjX, &OpenLjX};

}  // namespace scancal
