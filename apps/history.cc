// scancal history FILES or FOLDER
#include <gflags/gflags.h>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <numeric>
#include "apps/command.h"
#include "apps/recheck.h"
#include "io/json_file.h"
#include "io/output_file.h"
#include "models/models.h"
#include "report/difference.h"
#include "report/page.h"

DECLARE_string(format);
DECLARE_string(language);
DECLARE_string(out);

namespace scancal {
namespace {

namespace fs = std::filesystem;

// Every calibration.json in a folder and below it; without one, what ends in .json in it.
Result<std::vector<fs::path>> FilesOf(const std::vector<std::string>& arguments) {
  std::vector<fs::path> files;
  for (const std::string& argument : arguments) {
    if (!fs::is_directory(argument)) {
      files.emplace_back(argument);
      continue;
    }
    std::vector<fs::path> named, others;
    std::error_code error;
    for (const auto& entry : fs::recursive_directory_iterator(argument, error)) {
      const fs::path& path = entry.path();
      if (path.filename() == "calibration.json") named.push_back(path);
      else if (path.extension() == ".json" && path.parent_path() == fs::path(argument)) others.push_back(path);
    }
    if (error) return Error{argument + ": " + error.message()};
    if (named.empty()) named = std::move(others);
    if (named.empty()) return Error{argument + ": found no calibration.json in it or below it"};
    std::sort(named.begin(), named.end());
    files.insert(files.end(), named.begin(), named.end());
  }
  if (files.size() < 2)
    return Error{"found " + std::to_string(files.size()) + " calibration.json, expected two or more of one instrument"};
  return files;
}

std::string NameOf(const fs::path& file) {
  const std::string folder = file.parent_path().filename().string();
  return file.filename() == "calibration.json" && !folder.empty() ? folder : file.stem().string();
}

// As the certificate says when it was performed; the command line and the time of a run take no part.
std::optional<double> DayOf(const Json& file) {
  const Json::json_pointer at("/certificate/performed/end");
  int year = 0;
  unsigned month = 0, day = 0;
  if (!file.contains(at) || !file.at(at).is_string() ||
      std::sscanf(file.at(at).get<std::string>().c_str(), "%d-%u-%u", &year, &month, &day) != 3)
    return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(month), std::chrono::day(day)};
  if (!date.ok()) return std::nullopt;
  return static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
}

// Orders them by day where all have one and not all the same.
void Order(std::vector<Rechecked>* all, History* history) {
  std::vector<std::optional<double>> days;
  for (const Rechecked& each : *all) days.push_back(DayOf(each.file));
  const bool dated = std::all_of(days.begin(), days.end(), [](const auto& day) { return day.has_value(); }) &&
                     *std::max_element(days.begin(), days.end()) > *std::min_element(days.begin(), days.end());
  std::vector<size_t> order(all->size());
  std::iota(order.begin(), order.end(), size_t{0});
  if (dated) std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return *days[a] < *days[b]; });
  std::vector<Rechecked> ordered;
  std::vector<std::string> names;
  for (const size_t k : order) {
    history->times.push_back(dated ? *days[k] - *days[order[0]] : static_cast<double>(ordered.size() + 1));
    names.push_back(history->calibrations[k]);
    ordered.push_back(std::move((*all)[k]));
  }
  history->unit_of_time = dated ? "day" : "calibration";
  history->calibrations = std::move(names);
  *all = std::move(ordered);
}

Result<int> Watched(const std::vector<std::string>& arguments) {
  const std::string format = FLAGS_format.empty() ? "text" : FLAGS_format;
  if (format != "text" && format != "csv" && format != "json")
    return Error{"--format: found \"" + format + "\", expected text, csv or json"};
  SCANCAL_RETURN_IF_ERROR(CheckLanguage());
  SCANCAL_ASSIGN_OR_RETURN(const std::vector<fs::path> files, FilesOf(arguments));
  std::vector<Rechecked> all;
  History history;
  int code = kTrusted;
  for (const fs::path& file : files) {
    SCANCAL_ASSIGN_OR_RETURN(Rechecked each, RecheckForUse(CalibrationIn(file)));
    if (!all.empty() && each.found.model != all[0].found.model)
      return Error{file.string() + ": is of model \"" + each.found.model + "\", the others of \"" + all[0].found.model +
                   "\"; expected calibrations of one instrument"};
    code |= WarnOf(each, file);
    history.calibrations.push_back(NameOf(CalibrationIn(file)));
    all.push_back(std::move(each));
  }
  Order(&all, &history);
  std::vector<Calibration> found;
  for (const Rechecked& each : all) found.push_back(each.found);
  const Series series = SeriesOf(found, AnewInEachCalibration());
  if (series.names.empty()) return Error{"the calibrations have no estimated parameter in common"};
  history.shared = series.shared;
  history.charts = ChartsOf(series, history.times);
  const std::vector<std::string> alarms = AlarmsOf(history);
  if (format == "text") {
    std::printf("%s", ToText(history).c_str());
    for (const std::string& alarm : alarms) std::printf("%s\n", alarm.c_str());
    if (alarms.empty()) std::printf("no alarm: all %zu agree within what is known of them\n", found.size());
  } else {
    std::printf("%s", format == "csv" ? ToCsv(history).c_str() : (ToJson(history).dump(1) + "\n").c_str());
  }
  if (!FLAGS_out.empty()) {
    SCANCAL_ASSIGN_OR_RETURN(const bool written, WriteHistoryPage(ToJson(history), FLAGS_out, FLAGS_language));
    if (!written) return kBadInput;
  }
  return alarms.empty() ? code : kFoundOut;
}

int RunHistory(const std::vector<std::string>& arguments) {
  const Result<int> code = Watched(arguments);
  return code.ok() ? *code : Complain(code.error().message);
}

}  // namespace

const Command kHistoryCommand = {
    "history",
    "FILES",
    "control charts of every parameter over calibrations of one instrument: drift, limits, CUSUM",
    {{"format", "text, csv or json, on standard output"},
     {"out", "HTML page to write"},
     {"language"},
     {"unreliable"},
     {"key"}},
    &RunHistory};

}  // namespace scancal
