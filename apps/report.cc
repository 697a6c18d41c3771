// scancal report CALIBRATION.json
#include <gflags/gflags.h>
#include <cstdio>
#include <filesystem>
#include "apps/calibrate.h"
#include "apps/command.h"
#include "io/json_file.h"
#include "report/page.h"

DECLARE_string(out);
DEFINE_string(pdf, "", "PDF to write: the page on A4");
DEFINE_string(dcc, "", "XML to write: a Digital Calibration Certificate, of what `certificate:` in dataset.yaml says");
DEFINE_string(figures, "", "JSON to write: the numbers that the figures are drawn from");
DEFINE_string(previous, "", "an earlier calibration.json: as found and as left, with E_n");
DEFINE_string(language, "en", "of the page: en or de");

namespace scancal {
namespace {

Result<void> WriteFigures(const std::filesystem::path& calibration, const Json& figures) {
  std::error_code none;
  if (std::filesystem::equivalent(calibration, FLAGS_figures, none))
    return Error{"--figures: " + FLAGS_figures + " is the calibration itself, expected another file"};
  if (!figures.is_null()) return WriteJson(FLAGS_figures, figures);
  SCANCAL_ASSIGN_OR_RETURN(const Json json, ReadJson(calibration));  // as older versions kept them
  Json kept = Json::object();
  for (const char* key : {"compare", "surface", "residuals", "messages"})
    if (json.contains(key)) kept[key] = json[key];
  return WriteJson(FLAGS_figures, kept);
}

int RunReport(const std::vector<std::string>& arguments) {
  if (arguments.size() != 1)
    return Complain("found " + std::to_string(arguments.size()) + " arguments, expected one: a calibration.json");
  const Result<void> spoken = CheckLanguage();
  if (!spoken.ok()) return Complain(spoken.error().message);
  std::filesystem::path calibration = arguments[0];
  if (std::filesystem::is_directory(calibration)) calibration /= "calibration.json";
  PageChoice choice{FLAGS_out, FLAGS_pdf, FLAGS_dcc, FLAGS_previous, FLAGS_language};
  if (choice.html.empty() && choice.pdf.empty() && choice.dcc.empty() && FLAGS_figures.empty())
    choice.html = calibration.parent_path() / "report.html";
  for (const std::filesystem::path& file : {choice.html, choice.pdf, choice.dcc})
    if (!FLAGS_figures.empty() && file.lexically_normal() == std::filesystem::path(FLAGS_figures).lexically_normal())
      return Complain("--figures: " + FLAGS_figures +
                      " is written by the same command; give each file a name of its own");
  const Result<Json> figures = FiguresOf(calibration);
  if (!figures.ok()) return Complain(figures.error().message);
  const Result<bool> written = WritePage(calibration, *figures, choice);
  if (!written.ok()) return Complain(written.error().message);
  if (!*written) return kBadInput;
  if (!FLAGS_figures.empty()) {
    const Result<void> numbers = WriteFigures(calibration, *figures);
    if (!numbers.ok()) return Complain(numbers.error().message);
  }
  for (const std::filesystem::path& file : {choice.html, choice.pdf, choice.dcc, {FLAGS_figures}})
    if (!file.empty()) std::printf("%s\n", file.c_str());
  return kTrusted;
}

}  // namespace

Result<void> CheckLanguage() {
  std::string languages;
  for (const std::string language : kLanguages) {
    if (FLAGS_language == language) return {};
    languages += (languages.empty() ? "" : " or ") + language;
  }
  return Error{"--language: found \"" + FLAGS_language + "\", expected " + languages};
}

const Command kReportCommand = {
    "report",
    "FILE.json",
    "the page that is filed, of a calibration.json: what was measured, with what result, how sure",
    {{"out", "HTML page to write (default: report.html beside the calibration.json)"},
     {"pdf"},
     {"dcc"},
     {"figures"},
     {"previous"},
     {"language"}},
    &RunReport};

}  // namespace scancal
