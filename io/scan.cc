#include "io/scan.h"
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <utility>
#include "io/decoded_file.h"
#include "io/file_kind.h"
#include "io/message.h"
#include "io/npy.h"

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

std::string Lower(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c | 0x20) : c;
  return text;
}

// [mm] or (mm): mm; anything else as it is.
std::string_view WithoutBrackets(std::string_view text) {
  text = WithoutBlanks(text);
  const bool are_there =
      text.size() >= 2 && ((text.front() == '[' && text.back() == ']') || (text.front() == '(' && text.back() == ')'));
  return are_there ? WithoutBlanks(text.substr(1, text.size() - 2)) : text;
}

std::optional<char> ReadSign(YamlMap& map, const char* key, const std::map<std::string, char>& signs,
                             const std::string& expected) {
  if (!map.Has(key)) return std::nullopt;
  const auto found = signs.find(map.Text(key));
  if (found != signs.end()) return found->second;
  map.Fail(key, "expected " + expected);
  return std::nullopt;
}

void ReadDialect(YamlMap map, TextFormat* format) {
  static const std::map<std::string, char> separators = {{",", ','},         {"comma", ','},  {";", ';'},
                                                         {"semicolon", ';'}, {"tab", '\t'},   {"\t", '\t'},
                                                         {" ", ' '},         {"spaces", ' '}, {"blanks", ' '}};
  if (const auto sign = ReadSign(map, "separator", separators, "\",\", \";\", tab or spaces")) format->separator = sign;
  if (const auto sign = ReadSign(map, "decimal", {{".", '.'}, {",", ','}}, "\".\" or \",\"")) format->decimal = sign;
  if (map.Has("header_lines")) {
    const double lines = map.Number("header_lines");
    if (lines < 0 || lines > 1000 || std::floor(lines) != lines)
      map.Fail("header_lines", "expected how many lines stand before the first line of data, up to 1000");
    else format->header_lines = static_cast<int64_t>(lines);
  }
  if (map.Has("encoding")) {
    const std::string encoding = Lower(map.Text("encoding"));
    format->windows_1252 =
        encoding == "cp1252" || encoding == "windows-1252" || encoding == "latin-1" || encoding == "iso-8859-1";
    if (!*format->windows_1252 && encoding != "utf-8" && encoding != "utf-16")
      map.Fail("encoding", "expected utf-8, utf-16 or cp1252");
  }
}

bool IsNpy(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".npy";
}

}  // namespace

std::optional<double> MatchColumn(const ScanColumn& wanted, std::string_view found, const Units& units,
                                  std::string_view own_unit) {
  found = WithoutBlanks(found);
  if (!found.starts_with(wanted.name)) return std::nullopt;
  const std::string_view rest = WithoutBlanks(found.substr(wanted.name.size()));
  if (rest.empty()) {
    own_unit = WithoutBrackets(own_unit);
    return own_unit.empty() ? units.Of(wanted.dimension) : HeaderUnit(own_unit, wanted.dimension);
  }
  if (rest.front() == '_') return UnitSize(rest.substr(1), wanted.dimension);
  if (rest.front() == '/') return HeaderUnit(WithoutBlanks(rest.substr(1)), wanted.dimension);
  const std::string_view inside = WithoutBrackets(rest);
  if (inside.size() == rest.size()) return std::nullopt;
  return wanted.dimension == Dimension::kNone ? 1.0 : HeaderUnit(inside, wanted.dimension);
}

Result<std::vector<ChosenColumn>> ChooseColumns(const ScanFormat& format, const std::vector<std::string>& found,
                                                const std::string& place, const std::vector<std::string>& units) {
  std::vector<ChosenColumn> chosen;
  const std::string shown = Listed(Masked(found));
  for (const ScanColumn& wanted : format.columns) {
    std::optional<ChosenColumn> match;
    ScanColumn named = wanted;
    if (const auto own = format.names.find(wanted.name); own != format.names.end()) named.name = own->second;
    const std::string called = named.name;
    for (const bool any_case : {false, true}) {
      named.name = any_case ? Lower(called) : called;
      for (size_t i = 0; i < found.size(); ++i) {
        const std::string name = any_case ? Lower(found[i]) : found[i];
        const auto factor = MatchColumn(named, name, format.units, i < units.size() ? units[i] : "");
        if (!factor) continue;
        if (match) {
          return Error{place + ": found the column '" + wanted.name + "' twice, as '" + found[match->index] +
                       "' and '" + found[i] + "', expected it once"};
        }
        match = ChosenColumn{.name = wanted.name, .index = i, .factor = *factor};
      }
      if (match) break;
    }
    named.name = called;
    if (!match && wanted.required) {
      return Error{place + ": found the columns " + shown + ", expected also " + PossibleNames(named) + wanted.remedy,
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

void ReadColumnNames(YamlMap map, ScanFormat* format) {
  if (map.IsMap("columns")) {
    YamlMap names = map.Map("columns");
    for (const std::string& name : names.Keys()) {
      const auto is_it = [&](const ScanColumn& wanted) { return wanted.name == name; };
      if (std::none_of(format->columns.begin(), format->columns.end(), is_it))
        names.Fail(name, "no column has this name here; the file's own name stands behind the colon");
      format->names[name] = names.Text(name);
    }
  } else if (map.Has("columns")) {
    format->npy_columns = map.Texts("columns");
  }
}

void ReadTextFormat(YamlMap map, ScanFormat* format) {
  if (map.Has("text")) ReadDialect(map.Map("text"), &format->text);
  if (!map.Has("where")) return;
  YamlMap where = map.Map("where");
  for (const std::string& column : where.Keys()) format->text.where.emplace_back(column, where.Text(column));
}

void ReadFormat(YamlMap map, const std::filesystem::path& folder, ScanFormat* format) {
  if (map.Has("format")) {
    format->kind = map.Text("format");
    if (!NamedFileKind(format->kind)) map.Fail("format", "expected one of " + Listed(FileKindNames()));
  }
  ReadColumnNames(map, format);
  ReadTextFormat(map, format);
  if (map.Has("topic")) format->ros.topic = map.Text("topic");
  if (map.Has("joint")) format->ros.joint = map.Text("joint");
  if (map.Has("joint_topic")) format->ros.joint_topic = map.Text("joint_topic");
  if (map.Has("angle")) format->angle = ReadLoggedAngle(map.Map("angle"), folder, format->units);
  if (map.IsNumber("invalid")) {
    format->invalid = map.Number("invalid");
  } else if (map.IsList("invalid")) {
    for (const std::string& text : map.Texts("invalid")) {
      const ParsedNumber number = ParseNumber(text);
      if (number.kind != NumberKind::kNumber) format->text.missing.push_back(text);
      else if (format->invalid) format->more_invalid.push_back(number.value);
      else format->invalid = number.value;
    }
  } else if (map.Has("invalid")) {
    format->text.missing.push_back(map.Text("invalid"));
  }
}

Result<std::vector<std::pair<size_t, std::string>>> ChooseWhere(const ScanFormat& format,
                                                                const std::vector<std::string>& found,
                                                                const std::string& place) {
  std::vector<std::pair<size_t, std::string>> where;
  for (const auto& [name, value] : format.text.where) {
    ScanFormat only;
    only.columns = {{name, Dimension::kNone}};
    SCANCAL_ASSIGN_OR_RETURN(const auto column, ChooseColumns(only, found, place + ": where"));
    where.emplace_back(column.front().index, value);
  }
  return where;
}

Error NoPoints(const ScanFormat& format, int64_t lines_in_file, const std::string& first_unwanted) {
  const std::string name = format.path.string();
  if (lines_in_file == 0) return Error{name + ": no points: the file is empty"};
  if (!first_unwanted.empty() || (!format.text.where.empty() && !format.lines)) {
    std::string wanted;
    for (const auto& [column, value] : format.text.where)
      wanted += (wanted.empty() ? "" : ", ") + column + ": " + value;
    return Error{name + ": no points: no row is as where: {" + wanted + "} asks" +
                 (first_unwanted.empty() ? "" : "; the first has " + first_unwanted)};
  }
  if (!format.lines) return Error{name + ": no points: found at most a header and comments, expected lines of data"};
  return Error{name + ": no points in the lines " + std::to_string(format.lines->first) + " to " +
               std::to_string(format.lines->second)};
}

int ScanBatch::Find(std::string_view name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

Result<std::unique_ptr<ScanReader>> ScanReader::Open(const ScanFormat& format) {
  if (format.angle) return OpenLogged(format);
  SCANCAL_ASSIGN_OR_RETURN(const FileKind* const kind, FindFileKind(format));
  if (kind != nullptr) return kind->open(format);
  if (format.layout) return OpenWideCsv(format);
  SCANCAL_ASSIGN_OR_RETURN(DecodedFile file, DecodedFile::Open(format.path));
  const bool is_array = IsNpy(format.path) || file.start().starts_with(kNpyStart);
  auto reader = is_array ? OpenNpy(format, std::move(file)) : OpenCsv(format, std::move(file));
  if (reader.ok() || reader.error().kind != ErrorKind::kUnknownLayout) return reader;
  return Error{reader.error().message + (IsReadOnce(format.path) ? "; of a pipe only text and .npy are read; write it "
                                                                   "into a file"
                                                                 : TriedFileKinds()),
               ErrorKind::kUnknownLayout};
}

}  // namespace scancal
