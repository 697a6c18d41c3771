#include "apps/done.h"
#include <gflags/gflags.h>
#include <algorithm>
#include <array>
#include <cmath>
#include "apps/command.h"
#include "io/input_file.h"
#include "io/json_file.h"

DECLARE_bool(report);
DECLARE_string(sign);

namespace scancal {
namespace {

namespace fs = std::filesystem;

Json FlagsNow() {
  Json flags = Json::object();
  for (const CommandFlag& flag : kRefineCommand.flags)
    if (ChangesResult(flag.name)) flags[flag.name] = gflags::GetCommandLineFlagInfoOrDie(flag.name).current_value;
  return flags;
}

std::string Absolute(const fs::path& path) {
  std::error_code error;
  const fs::path whole = fs::weakly_canonical(path, error);
  return error ? path.string() : whole.string();
}

std::vector<std::string> WrittenNow() {
  std::vector<std::string> files = {"calibration.json"};
  if (FLAGS_report) files.emplace_back("report.html");
  if (!FLAGS_sign.empty()) files.emplace_back("calibration.json.sig");
  return files;
}

Json Hashed(const std::string& file, const std::string& sha256) { return {{"file", file}, {"sha256", sha256}}; }

// Of a list of {"file", "sha256"}: all are as they were. What has no hash, as a pipe, never is.
bool AreAsTheyWere(const Json& list, const fs::path& folder) {
  if (!list.is_array() || list.empty()) return false;
  return std::all_of(list.begin(), list.end(), [&](const Json& each) {
    if (!each.is_object() || !each.contains("file") || !each["file"].is_string() || !each.contains("sha256"))
      return false;
    const Result<std::string> sha256 = Sha256(folder / each["file"].get<std::string>());
    return sha256.ok() && each["sha256"] == *sha256;
  });
}

Json NumberOrNull(double number) { return std::isfinite(number) ? Json(number) : Json(nullptr); }

}  // namespace

bool ChangesResult(const std::string& flag) {
  constexpr std::array kOthers = {"out", "batch", "threads", "accept_unreliable", "resume"};
  return std::find(kOthers.begin(), kOthers.end(), flag) == kOthers.end();
}

Result<void> WriteDone(const fs::path& folder, const std::string& dataset, const std::vector<fs::path>& read,
                       const Calibration& calibration) {
  Json done = {{"dataset", Absolute(dataset)},
               {"version", calibration.version},
               {"flags", FlagsNow()},
               {"read", Json::array()},
               {"written", Json::array()},
               {"model", calibration.model},
               {"status", calibration.ok() ? "ok" : "unreliable"},
               {"unreliable", Json::array()},
               {"seconds", calibration.seconds},
               {"parameters", Json::array()}};
  for (size_t k = 0; k < read.size(); ++k)
    done["read"].push_back(Hashed(Absolute(read[k]), calibration.inputs[k].sha256));
  for (const std::string& file : WrittenNow()) {
    SCANCAL_ASSIGN_OR_RETURN(const std::string sha256, Sha256(folder / file));
    done["written"].push_back(Hashed(file, sha256));
  }
  for (const Sentence& reason : calibration.unreliable) done["unreliable"].push_back(reason.english);
  for (const Parameter& p : calibration.parameters) {
    if (p.role == Role::kHold) continue;
    done["parameters"].push_back(
        {{"name", p.name}, {"unit", Name(p.unit)}, {"value", NumberOrNull(p.value)}, {"u", NumberOrNull(p.u)}});
  }
  return WriteJson(folder / kDoneFile, done);
}

Json FindDone(const fs::path& folder, const std::string& dataset) {
  Result<Json> found = ReadJson(folder / kDoneFile);
  if (!found.ok() || !found->is_object()) return nullptr;
  Json done = *std::move(found);
  const bool same = done["dataset"] == Absolute(dataset) && done["version"] == SCANCAL_VERSION &&
                    done["flags"] == FlagsNow() && done["status"].is_string();
  return same && AreAsTheyWere(done["written"], folder) && AreAsTheyWere(done["read"], "") ? done : Json(nullptr);
}

}  // namespace scancal
