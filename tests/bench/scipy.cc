#include "tests/bench/scipy.h"
#include <glog/logging.h>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

namespace scancal::bench {

void WriteForScipy(const LargeData& data, const std::filesystem::path& folder) {
  const auto written = turntable::WriteSimulated(LargeScene(), turntable::ScanFileFormat::kNpy, folder);
  CHECK(written.ok()) << written.error().message;
  nlohmann::json start = {{"M", data.start.M}, {"N", data.start.N}};
  const auto list = [](const Eigen::Vector3d& v) { return std::vector{v[0], v[1], v[2]}; };
  for (const turntable::Model::Target& plane : data.start.planes)
    start["planes"].push_back({{"file", plane.name + ".npy"},
                               {"normal", list(plane.normal)},
                               {"e1", list(plane.e1)},
                               {"e2", list(plane.e2)},
                               {"distance", plane.distance}});
  std::ofstream(folder / "start.json") << start;
}

ScipyFit RunScipy(const std::filesystem::path& script, const std::filesystem::path& folder,
                  const std::string& residual) {
  const std::filesystem::path answer = folder / ("scipy_" + residual + ".json");
  const std::string command = "/usr/bin/python3 '" + script.string() + "' '" + folder.string() + "' " + residual +
                              " > '" + answer.string() + "'";
  CHECK_EQ(std::system(command.c_str()), 0) << command;
  const auto json = nlohmann::json::parse(std::ifstream(answer));
  return {json["M"],       json["N"],     json["cost"],    json["seconds"],
          json["peak_mb"], json["calls"], json["version"], json["method"]};
}

}  // namespace scancal::bench
