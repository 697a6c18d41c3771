// scancal_bench FOLDER [SCIPY_SCRIPT]: the comparisons of docs/speed.md, measured side by side. See scripts/bench.
#include <fmt/format.h>
#include <glog/logging.h>
#include <fstream>
#include <thread>
#include "tests/bench/comparisons.h"

namespace scancal::bench {
namespace {

std::string Processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown processor";
}

void Run(const std::filesystem::path& folder, const std::filesystem::path& scipy_script) {
  Table table;
  table.Note(
      "Times are processor seconds (those of the two threads that search the grid within \"everything after reading\" "
      "add up), one thread on either side of all else.");
  CompareCompression(&table);
  CompareReading(folder, &table);
  CompareScaling(&table);
  CompareMonteCarlo(&table);
  CompareRobot(scipy_script.empty() ? "" : scipy_script.parent_path() / "scipy_robot.py", folder, &table);
  Say("three placements, three million points");
  LargeData data;
  data.points = turntable::Simulate(LargeScene());
  data.placements = Compress(data.points);
  data.start = SearchStart(data.placements);
  CompareGrid(data, &table);
  CompareJoint(data, scipy_script, folder, &table);
  fmt::print("{}, {} cores\n\n", Processor(), std::thread::hardware_concurrency());
  table.Print();
}

}  // namespace
}  // namespace scancal::bench

int main(int argc, char** argv) {
  FLAGS_minloglevel = google::WARNING;
  google::InitGoogleLogging(argv[0]);
  CHECK(argc == 2 || argc == 3) << "usage: scancal_bench FOLDER [SCIPY_SCRIPT]";
  scancal::bench::Run(argv[1], argc == 3 ? argv[2] : "");
  return 0;
}
