// scancal report CALIBRATION.json
#include <gflags/gflags.h>
#include <cstdio>
#include <filesystem>
#include "apps/command.h"
#include "report/page.h"

DECLARE_string(out);
DEFINE_string(pdf, "", "PDF to write: the page on A4");
DEFINE_string(dcc, "", "XML to write: a Digital Calibration Certificate, of what `certificate:` in dataset.yaml says");
DEFINE_string(previous, "", "an earlier calibration.json: as found and as left, with E_n");
DEFINE_string(language, "en", "of the page: en or de");

namespace scancal {
namespace {

int RunReport(const std::vector<std::string>& arguments) {
  if (arguments.size() != 1)
    return Complain("found " + std::to_string(arguments.size()) + " arguments, expected one: a calibration.json");
  const Result<void> spoken = CheckLanguage();
  if (!spoken.ok()) return Complain(spoken.error().message);
  std::filesystem::path calibration = arguments[0];
  if (std::filesystem::is_directory(calibration)) calibration /= "calibration.json";
  PageChoice choice{FLAGS_out, FLAGS_pdf, FLAGS_dcc, FLAGS_previous, FLAGS_language};
  if (choice.html.empty() && choice.pdf.empty() && choice.dcc.empty())
    choice.html = calibration.parent_path() / "report.html";
  const Result<bool> written = WritePage(calibration, choice);
  if (!written.ok()) return Complain(written.error().message);
  if (!*written) return kBadInput;
  for (const std::filesystem::path& file : {choice.html, choice.pdf, choice.dcc})
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
     {"previous"},
     {"language"}},
    &RunReport};

}  // namespace scancal
