#include "io/scan.h"
#include <algorithm>
#include <cctype>
#include <cstring>
#include <utility>
#include "io/message.h"

namespace scancal {
namespace {

// y (or y_mm, y_m, y_um)
std::string PossibleNames(const ScanColumn& wanted) {
  switch (wanted.dimension) {
    case Dimension::kLength:
      return "'" + wanted.name + "' (or " + wanted.name + "_mm, _m, _um)";
    case Dimension::kAngle:
      return "'" + wanted.name + "' (or " + wanted.name + "_deg, _rad)";
    case Dimension::kNone:
      break;
  }
  return "'" + wanted.name + "'";
}

// What a file that is no table begins with is nobody's business.
std::vector<std::string> Masked(std::vector<std::string> names) {
  constexpr size_t kLongest = 24;
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || c >= 0x80 || std::strchr(" _-.%()[]/*^#\"", c) != nullptr;
  };
  const bool alone = names.size() == 1;
  for (std::string& name : names) {
    const bool is_name = name.size() <= kLongest && std::all_of(name.begin(), name.end(), plain);
    if (is_name && !alone) continue;
    if (name.size() > kLongest) name.replace(kLongest, std::string::npos, "...");
    for (char& c : name)
      c = std::isdigit(static_cast<unsigned char>(c)) != 0   ? '0'
          : std::isalpha(static_cast<unsigned char>(c)) != 0 ? 'x'
                                                             : c;
  }
  return names;
}

bool IsNpy(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".npy";
}

}  // namespace

std::optional<double> MatchColumn(const ScanColumn& wanted, std::string_view found, const Units& units) {
  if (!found.starts_with(wanted.name)) return std::nullopt;
  const std::string_view suffix = found.substr(wanted.name.size());
  if (suffix.empty()) return units.Of(wanted.dimension);
  return suffix.front() == '_' ? UnitSize(suffix.substr(1), wanted.dimension) : std::nullopt;
}

Result<std::vector<ChosenColumn>> ChooseColumns(const ScanFormat& format, const std::vector<std::string>& found,
                                                const std::string& place) {
  std::vector<ChosenColumn> chosen;
  const std::string shown = Listed(Masked(found));
  for (const ScanColumn& wanted : format.columns) {
    std::optional<ChosenColumn> match;
    for (size_t i = 0; i < found.size(); ++i) {
      const auto factor = MatchColumn(wanted, found[i], format.units);
      if (!factor) continue;
      if (match) {
        return Error{place + ": found the column '" + wanted.name + "' twice, as '" + found[match->index] + "' and '" +
                     found[i] + "', expected it once"};
      }
      match = ChosenColumn{.name = wanted.name, .index = i, .factor = *factor};
    }
    if (!match && wanted.required) {
      return Error{place + ": found the columns " + shown + ", expected also " + PossibleNames(wanted) + wanted.remedy,
                   ErrorKind::kMissingColumns};
    }
    if (match) chosen.push_back(*match);
  }
  const auto has = [&](const std::string& name) {
    return std::any_of(chosen.begin(), chosen.end(), [&](const ChosenColumn& column) { return column.name == name; });
  };
  const auto whole = [&](const auto& group) { return std::all_of(group.begin(), group.end(), has); };
  if (!format.one_of.empty() && std::none_of(format.one_of.begin(), format.one_of.end(), whole)) {
    std::string groups;
    for (const auto& group : format.one_of) groups += (groups.empty() ? "" : "; or ") + Listed(group);
    return Error{place + ": found the columns " + shown + ", expected also " + groups, ErrorKind::kMissingColumns};
  }
  if (chosen.empty()) return Error{place + ": found the columns " + shown + ", none of them is known"};
  return chosen;
}

Error NoPoints(const ScanFormat& format, int64_t lines_in_file) {
  const std::string name = format.path.string();
  if (lines_in_file == 0) return Error{name + ": no points: the file is empty"};
  if (!format.lines) return Error{name + ": no points: found at most a header and comments, expected lines of data"};
  return Error{name + ": no points in the lines " + std::to_string(format.lines->first) + " to " +
               std::to_string(format.lines->second)};
}

int ScanBatch::Find(std::string_view name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

Result<std::unique_ptr<ScanReader>> ScanReader::Open(const ScanFormat& format) {
  if (format.layout) return OpenWideCsv(format);
  return IsNpy(format.path) ? OpenNpy(format) : OpenCsv(format);
}

}  // namespace scancal
