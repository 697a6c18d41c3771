// scancal report CALIBRATION.json
#include <gflags/gflags.h>
#include <cstdio>
#include <filesystem>
#include "apps/calibrate.h"
#include "apps/command.h"
#include "io/json_file.h"
#include "models/models.h"
#include "report/difference.h"
#include "report/page.h"

DECLARE_string(out);
DEFINE_string(pdf, "", "PDF to write: the page on A4");
DEFINE_string(dcc, "", "XML to write: a Digital Calibration Certificate, of what `certificate:` in dataset.yaml says");
DEFINE_string(figures, "", "JSON to write: the numbers that the figures are drawn from");
DEFINE_string(previous, "", "an earlier calibration.json: as found and as left, with E_n");
DEFINE_string(language, "en", "of the page: en or de");

namespace scancal {
namespace {

Result<void> WriteFigures(const Rechecked& result, const Json& figures) {
  Json kept = Json::object();  // without data: as older versions kept them
  for (const char* key : {"compare", "surface", "residuals", "messages"})
    if (result.file.contains(key)) kept[key] = result.file[key];
  return WriteJson(FLAGS_figures, result.again ? figures : kept);
}

// A certificate is of what anybody can compute again.
Result<Json> CheckedFigures(const Rechecked& result, const PageChoice& choice) {
  for (const Sentence& doubt : result.doubts) {
    if (!choice.dcc.empty()) return Error{"--dcc: no certificate: " + doubt.english};
    std::fprintf(stderr, "scancal: warning: %s\n", doubt.english.c_str());
  }
  Json figures = FiguresOf(result);
  if (choice.previous.empty()) return figures;
  SCANCAL_ASSIGN_OR_RETURN(const Rechecked previous, Recheck(choice.previous, /*monte_carlo=*/false));
  for (const Sentence& doubt : previous.doubts)
    std::fprintf(stderr, "scancal: warning: %s: %s\n", choice.previous.c_str(), doubt.english.c_str());
  const Series series = SeriesOf(std::vector{previous.found, result.found}, AnewInEachCalibration());
  figures["difference"] = ToJson(DifferenceOf(series), DoubtsAbout(previous.file, result.file));
  return figures;
}

int RunReport(const std::vector<std::string>& arguments) {
  if (arguments.size() != 1)
    return Complain("found " + std::to_string(arguments.size()) + " arguments, expected one: a calibration.json");
  const Result<void> spoken = CheckLanguage();
  if (!spoken.ok()) return Complain(spoken.error().message);
  const std::filesystem::path calibration = CalibrationIn(arguments[0]);
  PageChoice choice{FLAGS_out, FLAGS_pdf, FLAGS_dcc, FLAGS_previous, FLAGS_language};
  if (choice.html.empty() && choice.pdf.empty() && choice.dcc.empty() && FLAGS_figures.empty())
    choice.html = calibration.parent_path() / "report.html";
  for (const std::filesystem::path& file : {choice.html, choice.pdf, choice.dcc})
    if (!FLAGS_figures.empty() && file.lexically_normal() == std::filesystem::path(FLAGS_figures).lexically_normal())
      return Complain("--figures: " + FLAGS_figures +
                      " is written by the same command; give each file a name of its own");
  std::error_code none;
  if (std::filesystem::equivalent(calibration, FLAGS_figures, none))
    return Complain("--figures: " + FLAGS_figures + " is the calibration itself, expected another file");
  const Result<Rechecked> result = Recheck(calibration, /*monte_carlo=*/true);
  if (!result.ok()) return Complain(result.error().message);
  const Result<Json> figures = CheckedFigures(*result, choice);
  if (!figures.ok()) return Complain(figures.error().message);
  const Result<bool> written = WritePage(calibration, *figures, choice);
  if (!written.ok()) return Complain(written.error().message);
  if (!*written) return kBadInput;
  if (!FLAGS_figures.empty()) {
    const Result<void> numbers = WriteFigures(*result, *figures);
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
     {"language"},
     {"key"}},
    &RunReport};

}  // namespace scancal
