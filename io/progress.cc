#include "io/progress.h"
#include <sys/ioctl.h>
#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace scancal {
namespace {

using Seconds = std::chrono::duration<double>;
constexpr Seconds kSilence(0.3);   // what ends sooner needs no bar
constexpr Seconds kInterval(0.1);  // between two drawings

void Put(const std::string& text) {
  // A bar that cannot be drawn is no reason to stop.
  [[maybe_unused]] const ssize_t ignored = ::write(STDERR_FILENO, text.data(), text.size());
}

size_t TerminalWidth() {
  winsize size = {};
  const bool known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : 80;
}

std::string TimeLeft(Seconds elapsed, double fraction) {
  if (fraction <= 0) return "";
  const double left = std::ceil(elapsed.count() * (1 - fraction) / fraction);
  if (left < 100) return std::to_string(static_cast<int>(left)) + " s left";
  if (left < 6000) return std::to_string(static_cast<int>(std::ceil(left / 60))) + " min left";
  return std::to_string(static_cast<int64_t>(std::ceil(std::min(left, 1e12) / 3600))) + " h left";
}

// reading left.csv [#########           ]  45 % 12 s left
std::string Line(const std::string& label, Seconds elapsed, double fraction) {
  constexpr size_t kBarWidth = 30;
  const auto full = static_cast<size_t>(fraction * kBarWidth);
  const std::string percent = std::to_string(static_cast<int>(fraction * 100));
  std::string line = label + " [" + std::string(full, '#') + std::string(kBarWidth - full, ' ') + "] ";
  line.append(3 - percent.size(), ' ').append(percent).append(" % ");  // 0 to 100: three digits at most
  return line + TimeLeft(elapsed, fraction);
}

}  // namespace

Progress::Progress(std::string label, Seconds between_lines)
    : label_(std::move(label)),
      terminal_(::isatty(STDERR_FILENO) == 1),
      between_lines_(between_lines),
      start_(std::chrono::steady_clock::now()),
      last_(start_) {}

Progress::~Progress() {
  if (terminal_ && last_ != start_) Put("\x1b[K");
}

void Progress::Show(double fraction) {
  const auto now = std::chrono::steady_clock::now();
  const bool due = terminal_ ? now - start_ >= kSilence && now - last_ >= kInterval : now - last_ >= between_lines_;
  if (!due) return;
  last_ = now;
  const double shown = std::isnan(fraction) ? 0 : std::clamp(fraction, 0.0, 1.0);
  if (!terminal_) {
    const std::string left = TimeLeft(now - start_, shown);
    Put(label_ + ": " + std::to_string(static_cast<int>(shown * 100)) + " %" + (left.empty() ? "" : ", " + left) +
        "\n");
    return;
  }
  // A line as wide as the terminal would wrap and could not be wiped.
  Put(Line(label_, now - start_, shown).substr(0, TerminalWidth() - 1).append("\x1b[K\r"));
}

}  // namespace scancal
