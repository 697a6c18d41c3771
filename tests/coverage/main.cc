// scancal_coverage [--sets=1000] [--sweep=44] [--row=NAME] [--verify]: the tables of docs/proof.md. See
// scripts/coverage.
#include <fmt/format.h>
#include <glog/logging.h>
#include <cctype>
#include <chrono>
#include <map>
#include <mutex>
#include "io/progress.h"
#include "tests/coverage/tally.h"
#include "tests/coverage/verify.h"

namespace scancal::coverage {
namespace {

constexpr int kThreads = 2;

struct Options {
  size_t sets = 1000;
  double sweep_deg = 44;
  std::string row;  // empty: all
  bool verify = false;
};

Options Parse(int argc, char** argv) {
  Options options;
  for (int k = 1; k < argc; ++k) {
    const std::string argument = argv[k], value = argument.substr(std::min(argument.size(), argument.find('=') + 1));
    if (argument.starts_with("--sets=")) {
      options.sets = std::stoul(value);
    } else if (argument.starts_with("--sweep=")) {
      options.sweep_deg = std::stod(value);
    } else if (argument == "--verify") {
      options.verify = true;
    } else {
      CHECK(argument.starts_with("--row="))
          << "usage: scancal_coverage [--sets=1000] [--sweep=44] [--row=NAME] [--verify]";
      options.row = value;
    }
  }
  CHECK_GT(options.sets, 0);
  return options;
}

// The beginning of a sentence, the same for other numbers.
std::string KindOf(const std::string& sentence) {
  constexpr size_t kLength = 60;
  std::string kind = sentence.substr(0, kLength);
  std::erase_if(kind, [](unsigned char c) { return std::isdigit(c); });
  return kind;
}

void Say(const Row& row, const std::vector<Trial>& trials, double seconds) {
  std::map<std::string, int> said;
  for (const Trial& trial : trials) {
    for (const std::string& why : trial.unreliable) ++said["unreliable: " + KindOf(why)];
    for (const std::string& what : trial.warnings) ++said["warning: " + KindOf(what)];
  }
  fmt::print(stderr, "{}: {} data sets in {:.0f} s\n", row.name, trials.size(), seconds);
  for (const auto& [kind, times] : said) fmt::print(stderr, "  {} x {} ...\n", times, kind);
}

std::vector<Trial> TryWithProgress(const Row& row, size_t number, size_t sets) {
  Progress progress(row.name);
  std::mutex one_at_a_time;
  double done = 0;
  return TryAll(row, number, sets, kThreads, [&] {
    const std::scoped_lock lock(one_at_a_time);
    progress.Show(++done / static_cast<double>(sets));
  });
}

// Of verified features, and whether 93 to 97 % of each kind are within U.
bool RunVerified(size_t sets) {
  bool hold = true;
  fmt::print("| kind | within U |\n| --- | --- |\n");
  for (const auto& [kind, count] : CountVerified(sets)) {
    const double share = count.within / count.trials;
    fmt::print("| {} | {:.1f} % |\n", kind, 100 * share);
    hold &= share >= 0.93 && share <= 0.97;
  }
  return hold;
}

bool Run(const Options& options) {
  if (options.verify) return RunVerified(options.sets);
  Table table;
  bool hold = true;
  size_t number = 0;
  for (const Row& row : Rows(options.sweep_deg)) {
    ++number;
    if (!options.row.empty() && row.name != options.row) continue;
    const auto began = std::chrono::steady_clock::now();
    const std::vector<Trial> trials = TryWithProgress(row, number, options.sets);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - began;
    Say(row, trials, seconds.count());
    const Tally tally = Count(trials);
    table.Add(row, tally);
    hold &= Holds(row, tally);
  }
  fmt::print("{}", table.Markdown());
  return hold;
}

}  // namespace
}  // namespace scancal::coverage

int main(int argc, char** argv) {
  FLAGS_minloglevel = google::WARNING;
  google::InitGoogleLogging(argv[0]);
  return scancal::coverage::Run(scancal::coverage::Parse(argc, argv)) ? 0 : 1;
}
