#include "io/scan_columns.h"
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
      return Error{place + ": found the columns " + Listed(found) + ", expected also " + PossibleNames(wanted)};
    }
    if (match) chosen.push_back(*match);
  }
  if (chosen.empty()) return Error{place + ": found the columns " + Listed(found) + ", none of them is known"};
  return chosen;
}

}  // namespace scancal
