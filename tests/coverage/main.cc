// scancal_coverage [--sets=1000] [--row=NAME]: the table of the README. See scripts/coverage.
#include <fmt/format.h>
#include <glog/logging.h>
#include <atomic>
#include <map>
#include "tests/coverage/tally.h"

namespace scancal::coverage {
namespace {

constexpr int kThreads = 2;

// What was said, and how often: numbers left out.
std::string Without(const std::string& text) {
  std::string kind;
  for (const char c : text)
    if (!std::isdigit(static_cast<unsigned char>(c)) && c != '.') kind += c;
  return kind.substr(0, 60);
}

void Report(const std::vector<Trial>& trials) {
  std::map<std::string, int> said;
  for (const Trial& trial : trials) {
    for (const std::string& why : trial.unreliable) ++said["unreliable: " + Without(why)];
    for (const std::string& what : trial.warnings) ++said["warning: " + Without(what)];
  }
  for (const auto& [what, times] : said) fmt::print(stderr, "  {} x {}\n", times, what);
}

int Run(size_t sets, const std::string& only) {
  Table table;
  bool all = true, any = false;
  const std::vector<Row> rows = Rows();
  for (size_t number = 0; number < rows.size(); ++number) {
    const Row& row = rows[number];
    if (!only.empty() && row.name != only) continue;
    any = true;
    std::atomic<size_t> done = 0;
    const std::vector<Trial> trials = TryAll(row, number, sets, kThreads, [&] {
      if (++done % 50 == 0) fmt::print(stderr, "\r{}: {} of {}", row.name, done.load(), sets);
    });
    fmt::print(stderr, "\n");
    Report(trials);
    const Tally tally = Count(trials);
    table.Add(row, tally);
    all &= Holds(row, tally);
  }
  CHECK(any) << "no row " << only;
  fmt::print("{}", table.Markdown());
  return all ? 0 : 1;
}

}  // namespace
}  // namespace scancal::coverage

int main(int argc, char** argv) {
  FLAGS_minloglevel = google::WARNING;
  google::InitGoogleLogging(argv[0]);
  size_t sets = 1000;
  std::string row;
  for (int k = 1; k < argc; ++k) {
    const std::string argument = argv[k];
    if (argument.starts_with("--sets=")) sets = std::stoul(argument.substr(7));
    else if (argument.starts_with("--row=")) row = argument.substr(6);
    else LOG(FATAL) << "usage: scancal_coverage [--sets=1000] [--row=NAME]";
  }
  return scancal::coverage::Run(sets, row);
}
