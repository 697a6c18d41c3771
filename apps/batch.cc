#include "apps/batch.h"
#include <fcntl.h>
#include <fmt/format.h>
#include <gflags/gflags.h>
#include <sched.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <map>
#include <vector>
#include "apps/command.h"
#include "apps/done.h"
#include "io/input_file.h"
#include "io/json_file.h"
#include "io/message.h"
#include "io/output_file.h"
#include "report/text.h"

namespace scancal {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr size_t kMostRows = 40;        // of the table
constexpr size_t kShownParameters = 3;  // in a row of it

struct DataSet {
  std::string given;  // as the list has it
  fs::path folder;    // of its result
  std::string status = "not started";
  bool unchanged = false;  // since an earlier run
  double seconds = 0;
  std::string reason;          // of a failure
  Json done = Json::object();  // model, unreliable, parameters of its done.json
};

Result<std::vector<DataSet>> ReadList(const std::string& list, const fs::path& folder) {
  SCANCAL_ASSIGN_OR_RETURN(const std::string text, ReadText(list == "-" ? "/dev/stdin" : list));
  const std::string name = list == "-" ? "standard input" : list;
  std::vector<DataSet> sets;
  std::map<fs::path, size_t> taken;  // by the data set of this line
  std::string_view rest = WithoutByteOrderMark(text);
  for (size_t line = 1; !rest.empty(); ++line) {
    const size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view given = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    while (!given.empty() && std::strchr(" \t\r", given.back())) given.remove_suffix(1);
    while (!given.empty() && std::strchr(" \t", given.front())) given.remove_prefix(1);
    if (given.empty() || given.front() == '#') continue;
    const std::string place = fmt::format("{}:{}: {}: ", name, line, Quoted(given));
    DataSet set;
    set.given = given;
    const fs::path path = set.given;
    if (std::find(path.begin(), path.end(), "..") != path.end())
      return Error{place +
                   "found .. in it, expected a path below the current folder, or from / on: its result has the "
                   "same place below " +
                   folder.string()};
    set.folder = (folder / path.relative_path()).lexically_normal();
    if (!set.folder.has_filename()) set.folder = set.folder.parent_path();  // a/ is a
    const auto [at, is_new] = taken.emplace(set.folder, line);
    if (!is_new)
      return Error{fmt::format("{}its result would be written to {}, as that of line {}; expected each data set once",
                               place, set.folder.string(), at->second)};
    sets.push_back(std::move(set));
  }
  if (sets.empty()) return Error{name + ": found no data set, expected the folder of one in each line"};
  return sets;
}

// Cores that this program may use, which a cluster's scheduler may have cut down.
int Cores() {
  cpu_set_t cores;
  return sched_getaffinity(0, sizeof cores, &cores) == 0 ? std::max(1, CPU_COUNT(&cores)) : 1;
}

std::vector<std::string> CommandFor(const DataSet& set, bool alone) {
  std::vector<std::string> command = {
      "scancal", "refine", set.given, "--out=" + set.folder.string(), "--accept_unreliable", "--resume"};
  for (const CommandFlag& flag : kRefineCommand.flags) {
    const auto info = gflags::GetCommandLineFlagInfoOrDie(flag.name);
    if (ChangesResult(flag.name) && !info.is_default) command.push_back("--" + info.name + "=" + info.current_value);
    if (info.name == "montecarlo" && !info.is_default && !alone) command.emplace_back("--threads=1");
  }
  if (set.given.starts_with("-")) command[2] = "./" + set.given;
  return command;
}

// The last line that a program that failed said.
std::string ReasonIn(const std::string& output) {
  const size_t end = output.find_last_not_of('\n');
  if (end == std::string::npos) return "it said nothing";
  const size_t before = output.rfind('\n', end), begin = before == std::string::npos ? 0 : before + 1;
  const std::string line = output.substr(begin, end + 1 - begin);
  return line.starts_with("scancal: ") ? line.substr(9) : line;
}

bool TellsResult(const Json& done) {
  const auto is_parameter = [](const Json& p) {
    if (!p.is_object() || !p.contains("name") || !p["name"].is_string() || !p.contains("unit") ||
        !p["unit"].is_string())
      return false;
    return std::ranges::all_of(std::array{"value", "u"}, [&](const char* key) {
      return p.contains(key) && (p[key].is_number() || p[key].is_null());
    });
  };
  return done.is_object() && done.contains("status") && done["status"].is_string() && done.contains("model") &&
         done.contains("unreliable") && done.contains("parameters") && done["parameters"].is_array() &&
         std::all_of(done["parameters"].begin(), done["parameters"].end(), is_parameter);
}

class Batch {
 public:
  Batch(std::vector<DataSet> sets, size_t at_a_time) : sets_(std::move(sets)), at_a_time_(at_a_time) {
    sigemptyset(&awaited_);
    sigaddset(&awaited_, SIGCHLD);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
      struct sigaction action = {};
      if (sigaction(signal, nullptr, &action) == 0 && action.sa_handler != SIG_IGN) sigaddset(&awaited_, signal);
    }
    std::signal(SIGCHLD, SIG_DFL);  // ignored, children would go without a word
    sigprocmask(SIG_BLOCK, &awaited_, &before_);
  }
  Batch(const Batch&) = delete;
  Batch& operator=(const Batch&) = delete;
  ~Batch() { sigprocmask(SIG_SETMASK, &before_, nullptr); }

  void Run() {
    for (size_t next = 0; (!signal_ && next < sets_.size()) || !running_.empty();) {
      while (!signal_ && next < sets_.size() && running_.size() < at_a_time_) Start(next++);
      if (running_.empty()) continue;  // none could be started
      const int signal = sigwaitinfo(&awaited_, nullptr);
      if (signal > 0 && signal != SIGCHLD) {
        signal_ = signal;
        for (const auto& [pid, run] : running_) kill(pid, SIGTERM);
      }
      int status = 0;
      for (pid_t pid; (pid = waitpid(-1, &status, WNOHANG)) > 0;) End(pid, status);
    }
  }
  const std::vector<DataSet>& sets() const { return sets_; }
  int signal() const { return signal_; }  // that ended it; 0: none

 private:
  struct Running {
    size_t set;
    int output;  // a file in memory
    Clock::time_point began;
  };

  void Start(size_t which) {
    std::vector<std::string> command = CommandFor(sets_[which], at_a_time_ == 1);
    std::vector<char*> words;
    for (std::string& word : command) words.push_back(word.data());
    words.push_back(nullptr);
    const int output = memfd_create("output", MFD_CLOEXEC);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, output, STDERR_FILENO);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setsigmask(&attributes, &before_);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
    pid_t pid = 0;
    const int error =
        output < 0 ? errno : posix_spawn(&pid, "/proc/self/exe", &actions, &attributes, words.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (error == 0) {
      running_[pid] = {which, output, Clock::now()};
      return;
    }
    if (output >= 0) close(output);
    sets_[which].status = "failed";
    sets_[which].reason = "no program could be started for it: " + SystemMessage(error);
    Tell(which);
  }

  void End(pid_t pid, int status) {
    const auto at = running_.find(pid);
    if (at == running_.end()) return;
    const Running run = at->second;
    running_.erase(at);
    DataSet& set = sets_[run.set];
    set.seconds = std::chrono::duration<double>(Clock::now() - run.began).count();
    std::string output(static_cast<size_t>(std::max<off_t>(0, lseek(run.output, 0, SEEK_END))), '\0');
    output.resize(static_cast<size_t>(std::max<ssize_t>(0, pread(run.output, output.data(), output.size(), 0))));
    close(run.output);
    Judge(status, output, &set);
    Tell(run.set);
  }

  void Judge(int status, const std::string& output, DataSet* set) const {
    set->status = "failed";
    if (WIFSIGNALED(status)) {
      const int signal = WTERMSIG(status);
      if (signal_) set->status = "interrupted";
      set->reason = fmt::format("ended by signal {} ({})", signal, strsignal(signal));
      if (signal == SIGKILL) set->reason += ": likeliest the memory did not suffice; try a smaller --threads";
      return;
    }
    set->unchanged = output.starts_with("unchanged");
    if (!set->unchanged) {
      const Result<void> kept = WriteFile(set->folder / "refine.txt", output);
      if (!kept.ok()) set->reason = kept.error().message;
    }
    if (WEXITSTATUS(status) != kTrusted) set->reason = ReasonIn(output);
    if (!set->reason.empty()) return;
    Result<Json> done = ReadJson(set->folder / kDoneFile);
    if (!done.ok() || !TellsResult(*done)) {
      set->reason = done.ok() ? "its done.json was edited: remove it" : done.error().message;
      return;
    }
    set->status = (*done)["status"];
    for (const char* key : {"model", "unreliable", "parameters"}) set->done[key] = (*done)[key];
  }

  void Tell(size_t which) {
    const DataSet& set = sets_[which];
    fmt::print("[{:{}}/{}] {:<11} {:>7.2f} s  {}{}{}\n", ++told_, std::to_string(sets_.size()).size(), sets_.size(),
               set.status, set.seconds, set.given, set.unchanged ? "  unchanged" : "",
               set.reason.empty() ? "" : ": " + set.reason);
    std::fflush(stdout);
  }

  std::vector<DataSet> sets_;
  size_t at_a_time_, told_ = 0;
  std::map<pid_t, Running> running_;
  sigset_t awaited_ = {}, before_ = {};
  int signal_ = 0;
};

Json SummaryOf(const std::vector<DataSet>& sets) {
  Json list = Json::array();
  for (const DataSet& set : sets) {
    Json json = {{"dataset", set.given},       {"out", set.folder.string()}, {"status", set.status},
                 {"unchanged", set.unchanged}, {"seconds", set.seconds},     {"reason", set.reason}};
    json.update(set.done);
    list.push_back(std::move(json));
  }
  return {{"version", SCANCAL_VERSION}, {"command", CommandLine()}, {"datasets", list}};
}

std::string Cell(std::string text) {  // RFC 4180
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  for (size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2) text.insert(at, 1, '"');
  return '"' + text + '"';
}

// Columns for the parameters of all data sets: M_mm, u_M_mm.
std::string Csv(const std::vector<DataSet>& sets) {
  std::vector<std::string> columns;
  std::map<std::string, size_t> column_of;
  std::vector<std::map<size_t, std::string>> values(sets.size());
  for (size_t s = 0; s < sets.size(); ++s) {
    if (!sets[s].done.contains("parameters")) continue;
    for (const Json& p : sets[s].done["parameters"])
      for (const char* key : {"value", "u"}) {
        const std::string unit = p["unit"], name = p["name"].get<std::string>() + (unit == "1" ? "" : "_" + unit);
        const auto [at, is_new] = column_of.emplace((*key == 'u' ? "u_" : "") + name, columns.size());
        if (is_new) columns.push_back(at->first);
        if (!p[key].is_null()) values[s][at->second] = p[key].dump();
      }
  }
  std::string text = "dataset,out,status,unchanged,seconds,reason";
  for (const std::string& column : columns) text += "," + Cell(column);
  for (size_t s = 0; s < sets.size(); ++s) {
    const DataSet& set = sets[s];
    text += fmt::format("\n{},{},{},{},{:.3f},{}", Cell(set.given), Cell(set.folder.string()), set.status,
                        set.unchanged ? 1 : 0, set.seconds, Cell(set.reason));
    for (size_t c = 0; c < columns.size(); ++c) text += "," + values[s][c];
  }
  return text + "\n";
}

std::string ResultOf(const DataSet& set) {
  if (!set.reason.empty()) return "";
  std::string text;
  size_t shown = 0;
  for (const Json& p : set.done.value("parameters", Json::array())) {
    if (!p["value"].is_number() || !p["u"].is_number() || !(p["u"].get<double>() > 0)) continue;
    if (++shown > kShownParameters) return text + ", ...";
    text += fmt::format("{}{} {} {}", text.empty() ? "" : ", ", p["name"].get<std::string>(),
                        Concise(p["value"], p["u"]), p["unit"].get<std::string>());
  }
  return text;
}

// All data sets where they are few, else those that are not ok; and how many are what.
std::string TableOf(const std::vector<DataSet>& sets) {
  TextTable table({"data set", "status", "result"});
  std::map<std::string, size_t> counts;
  size_t rows = 0, unchanged = 0;
  for (const DataSet& set : sets) {
    ++counts[set.status];
    unchanged += set.unchanged;
    if ((sets.size() > kMostRows && set.status == "ok") || ++rows > kMostRows) continue;
    table.Add({set.given, set.status, ResultOf(set)});
  }
  std::string text = rows > 0 ? "\n" + table.Text() : "";
  if (rows > kMostRows) text += fmt::format("... and {} more, see summary.csv\n", rows - kMostRows);
  text += fmt::format("\n{} data sets", sets.size());
  for (const auto& [status, count] : counts) text += fmt::format(", {} {}", count, status);
  return text + (unchanged ? fmt::format("; {} unchanged", unchanged) : "");
}

Result<void> WriteSummaries(const fs::path& folder, const std::vector<DataSet>& sets) {
  SCANCAL_RETURN_IF_ERROR(WriteFile(folder / "summary.csv", Csv(sets)));
  return WriteJson(folder / "summary.json", SummaryOf(sets));
}

}  // namespace

int RefineBatch(const std::string& list, const std::string& folder, int threads) {
  Result<std::vector<DataSet>> sets = ReadList(list, folder);
  if (!sets.ok()) return Complain("--batch: " + sets.error().message);
  const Clock::time_point began = Clock::now();
  Batch batch(*std::move(sets), static_cast<size_t>(threads > 0 ? threads : Cores()));
  batch.Run();
  const double seconds = std::chrono::duration<double>(Clock::now() - began).count();
  fmt::print("{}; {:.1f} s; {}\n", TableOf(batch.sets()), seconds, (fs::path(folder) / "summary.csv").string());
  const Result<void> written = WriteSummaries(folder, batch.sets());
  if (!written.ok()) return Complain(written.error().message);
  if (batch.signal()) {
    Complain("interrupted: the same command goes on where it stopped");
    std::signal(batch.signal(), SIG_DFL);
    std::raise(batch.signal());  // delivered when it is no longer held up, at the end of Batch
  }
  const auto computed = [](const DataSet& set) { return set.status == "ok" || set.status == "unreliable"; };
  return std::all_of(batch.sets().begin(), batch.sets().end(), computed) ? kTrusted : kBadInput;
}

}  // namespace scancal
