// The documents that people file: an HTML page, its print, a Digital Calibration Certificate.
#pragma once
#include <filesystem>
#include <string>
#include "io/json_file.h"
#include "io/result.h"

namespace scancal {

inline constexpr const char* kLanguages[] = {"en", "de"};  // that the page speaks

struct PageChoice {
  std::filesystem::path html, pdf, dcc;  // to be written; empty: not
  std::filesystem::path previous;        // an earlier calibration.json: as found, as left; empty: none
  std::string language = kLanguages[0];
};

// Of a calibration.json and FiguresToJson (null: the file has its own), by the program in report/page (Python, with
// Jinja2 and Matplotlib), which reads nothing else and writes whole files or none. It is looked for beside this
// program: in ../share/scancal/page where it is installed, in share/scancal/page where it was built. False: it has said
// why on standard error. An Error: it could not be started.
Result<bool> WritePage(const std::filesystem::path& calibration, const Json& figures, const PageChoice& choice);
// Control charts as a page, of ToJson(History); the same.
Result<bool> WriteHistoryPage(const Json& history, const std::filesystem::path& html, const std::string& language);

}  // namespace scancal
