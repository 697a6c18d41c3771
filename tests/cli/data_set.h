// Data sets for the tests of the program: simulated by the program itself, read, damaged and written again.
#pragma once
#include <gtest/gtest.h>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>
#include "io/json_file.h"
#include "tests/cli/program.h"
#include "tests/io/temporary_folder.h"

namespace scancal {

namespace fs = std::filesystem;

inline std::string ReadWhole(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

inline void WriteWhole(const fs::path& path, const std::string& contents) {
  std::ofstream(path, std::ios::binary) << contents;
}

// Replaces the first occurrence, which must be there.
inline void Replace(const fs::path& path, const std::string& from, const std::string& to) {
  std::string contents = ReadWhole(path);
  const size_t at = contents.find(from);
  ASSERT_NE(at, std::string::npos) << path << " has no " << from;
  WriteWhole(path, contents.replace(at, from.size(), to));
}

inline void Append(const fs::path& path, const std::string& text) { WriteWhole(path, ReadWhole(path) + text); }

inline std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// Line `number`, counted from 1, put in another's place.
inline void SetLine(const fs::path& path, size_t number, const std::string& line) {
  std::vector<std::string> lines = Lines(ReadWhole(path));
  ASSERT_LE(number, lines.size());
  lines[number - 1] = line;
  std::string text;
  for (const std::string& each : lines) text += each + "\n";
  WriteWhole(path, text);
}

struct ScanPoint {
  double angle = 0, y = 0, z = 0;  // as in the file; y may be nan
};

inline std::vector<ScanPoint> ReadPoints(const fs::path& path) {
  std::vector<ScanPoint> points;
  const std::vector<std::string> lines = Lines(ReadWhole(path));
  for (size_t i = 1; i < lines.size(); ++i) {
    ScanPoint p;
    if (std::sscanf(lines[i].c_str(), "%lf,%lf,%lf", &p.angle, &p.y, &p.z) != 3) {
      EXPECT_EQ(std::sscanf(lines[i].c_str(), "%lf,,%lf", &p.angle, &p.z), 2) << lines[i];
      p.y = std::nan("");
    }
    points.push_back(p);
  }
  return points;
}

// Columns in full digits.
inline void WriteTable(const fs::path& path, const std::string& header, const std::vector<std::vector<double>>& rows) {
  std::string text = header + "\n";
  for (const std::vector<double>& row : rows) {
    for (size_t c = 0; c < row.size(); ++c) {
      char cell[40];
      std::snprintf(cell, sizeof cell, "%s%.17g", c ? "," : "", row[c]);
      text += cell;
    }
    text += "\n";
  }
  WriteWhole(path, text);
}

inline void WritePoints(const fs::path& path, const std::vector<ScanPoint>& points) {
  std::vector<std::vector<double>> rows;
  for (const ScanPoint& p : points) rows.push_back({p.angle, p.y, p.z});
  WriteTable(path, "angle,y,z", rows);
}

// Points as profiles: a change of the angle starts one.
inline std::vector<std::vector<ScanPoint>> Profiles(const std::vector<ScanPoint>& points) {
  std::vector<std::vector<ScanPoint>> profiles;
  for (const ScanPoint& p : points) {
    if (profiles.empty() || profiles.back().front().angle != p.angle) profiles.emplace_back();
    profiles.back().push_back(p);
  }
  return profiles;
}

inline void Simulate(const fs::path& folder, std::vector<std::string> flags) {
  flags.insert(flags.begin(), "simulate");
  flags.push_back("--out=" + folder.string());
  const Outcome outcome = RunScancal(flags);
  ASSERT_EQ(outcome.exit_code, 0) << ::testing::PrintToString(outcome);
}

inline const std::vector<std::string> kNames = {"left", "centre", "right"};

// A test of the program with a folder of its own.
class CliTest : public ::testing::Test {
 protected:
  // Three placements of 40 profiles with 20 points, noise 0.05 mm: in folder_/name, a copy of what is simulated once.
  fs::path MakeData(const std::string& name = "data") const {
    static const Shared shared;
    fs::copy(shared.path, Path(name), fs::copy_options::recursive);
    return Path(name);
  }
  fs::path Path(const std::string& name) const { return folder_.path() / name; }

  // calibration.json lands in folder_/out.
  Outcome Refine(const fs::path& data, std::vector<std::string> flags = {}) const {
    flags.insert(flags.begin(), {"refine", data.string(), "--out=" + Path("out").string()});
    return RunScancal(flags);
  }
  Json Result() const {
    auto json = ReadJson(Path("out") / "calibration.json");
    if (json.ok()) return *json;
    ADD_FAILURE() << json.error().message;
    return Json::object();
  }
  // Refines and returns calibration.json; expects the exit code that goes with its status.
  Json Refined(const fs::path& data, int exit_code = 0, const std::vector<std::string>& flags = {}) const {
    const Outcome outcome = Refine(data, flags);
    EXPECT_EQ(outcome.exit_code, exit_code) << ::testing::PrintToString(outcome);
    if (outcome.exit_code == 1) return Json::object();
    EXPECT_EQ(outcome.err, "");
    Json result = Result();
    EXPECT_EQ(result["status"], exit_code == 0 ? "ok" : "unreliable") << outcome.out;
    return result;
  }

  TemporaryFolder folder_;

 private:
  struct Shared {
    fs::path path = fs::temp_directory_path() / ("scancal's shared data " + std::to_string(::getpid()));
    Shared() { Simulate(path, {"--profiles=40", "--points=20"}); }
    Shared(const Shared&) = delete;
    Shared& operator=(const Shared&) = delete;
    ~Shared() {
      std::error_code ignored;
      fs::remove_all(path, ignored);
    }
  };
};

// A parameter of calibration.json.
inline const Json& ParameterOf(const Json& calibration, const std::string& name) {
  static const Json nothing = {{"value", std::nan("")}, {"u", std::nan("")}, {"role", ""}};
  if (calibration.contains("parameters"))
    for (const Json& each : calibration["parameters"])
      if (each["name"] == name) return each;
  ADD_FAILURE() << "no parameter " << name;
  return nothing;
}
inline double ValueOf(const Json& calibration, const std::string& name) {
  return ParameterOf(calibration, name)["value"];
}
inline double UOf(const Json& calibration, const std::string& name) { return ParameterOf(calibration, name)["u"]; }

// The sentences of a list of calibration.json, one a line.
inline std::string Sentences(const Json& calibration, const std::string& key) {
  std::string text;
  if (calibration.contains(key))
    for (const Json& each : calibration[key]) text += each.get<std::string>() + "\n";
  return text;
}

}  // namespace scancal
