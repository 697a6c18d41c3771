#include <fmt/format.h>
#include <glog/logging.h>
#include <charconv>
#include <fstream>
#include <sstream>
#include "io/scan.h"
#include "tests/bench/comparisons.h"

namespace scancal::bench {
namespace {

// All numbers of the text, added up so that none is left out.
double BareLoop(const std::string& text) {
  const char* at = text.data() + text.find('\n') + 1;  // behind the names
  const char* const end = text.data() + text.size();
  double sum = 0;
  while (at < end) {
    double value = 0;
    at = std::from_chars(at, end, value).ptr + 1;  // over the comma or the end of the line
    sum += value;
  }
  return sum;
}

size_t ReadAll(const std::filesystem::path& file) {
  ScanFormat format;
  format.path = file;
  format.columns = {{"angle", Dimension::kAngle}, {"y", Dimension::kLength}, {"z", Dimension::kLength}};
  auto reader = ScanReader::Open(format);
  CHECK(reader.ok()) << reader.error().message;
  ScanBatch batch;
  size_t points = 0;
  for (;;) {
    const auto more = (*reader)->Next(&batch);
    CHECK(more.ok()) << more.error().message;
    if (!*more) return points;
    points += batch.size();
  }
}

std::string MegabytesPerSecond(double bytes, double seconds) {
  return fmt::format("{:.0f} MB/s", bytes / seconds / 1e6);
}

}  // namespace

void CompareReading(const std::filesystem::path& folder, Table* table) {
  Say("reading CSV");
  turntable::Scene scene = LargeScene();
  scene.placements = 1;
  scene.profiles = 3500;
  const auto written = turntable::WriteSimulated(scene, turntable::ScanFileFormat::kCsv, folder);
  CHECK(written.ok()) << written.error().message;
  const std::filesystem::path file = folder / "placement_1.csv";
  std::stringstream text;
  text << std::ifstream(file).rdbuf();  // which also brings it into the page cache
  const std::string bytes = text.str();

  size_t points = 0;
  volatile double keep = 0;
  const std::vector<double> seconds =
      MedianSecondsOf({[&] { points = ReadAll(file); }, [&] { keep = BareLoop(bytes); }});
  const double ours_s = seconds[0], bare_s = seconds[1];
  CHECK_EQ(points, static_cast<size_t>(scene.profiles) * static_cast<size_t>(scene.points));
  const auto size = static_cast<double>(bytes.size());
  const double ratio = bare_s / ours_s;
  table->Add({"reading CSV; other: a bare from_chars loop over the same bytes", MegabytesPerSecond(size, ours_s),
              MegabytesPerSecond(size, bare_s), Ratio(ratio), "at least 0.8", ratio >= 0.8 ? "yes" : "NO"});
  table->Note(
      fmt::format("CSV: angle, y, z of {:.1f} million points, {:.0f} MB in the page cache; the bare loop has them "
                  "in its own memory, ours opens and reads the file.",
                  static_cast<double>(points) / 1e6, size / 1e6));
}

}  // namespace scancal::bench
