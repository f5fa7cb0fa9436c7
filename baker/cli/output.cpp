#include "baker/cli/output.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <span>

#include <fmt/format.h>
#include <pthread.h>
#include <unistd.h>

namespace lambent::baker {

namespace {

std::string scaled(double value, double base, std::span<const char* const> units) {
  std::size_t unit = 0;
  for (; value >= base && unit + 1 < units.size(); ++unit) value /= base;
  return fmt::format("{:.{}f} {}", value, unit == 0 ? 0 : 1, units[unit]);
}

std::string progressText(const Progress::Stage& stage) {
  std::string text = stage.name;
  if (stage.total == 0) return fmt::format("{} ({})", text, durationText(stage.seconds));
  const double done = static_cast<double>(stage.done), total = static_cast<double>(stage.total);
  text += fmt::format(" {:5.1f} %", 100.0 * done / total);
  if (stage.done == 0 || stage.seconds <= 0.0) return text;
  const double rate = done / stage.seconds;
  return text +
         fmt::format("  {} {}/s  {} left", countText(rate), stage.unit, durationText((total - done) / rate));
}

}  // namespace

std::string countText(double count) {
  static constexpr std::array kUnits = {"", "k", "M", "G"};
  std::string text = scaled(count, 1000.0, kUnits);
  if (text.ends_with(' ')) text.pop_back();
  return text;
}

std::string bytesText(double bytes) {
  static constexpr std::array kUnits = {"B", "KiB", "MiB", "GiB"};
  return scaled(bytes, 1024.0, kUnits);
}

std::string durationText(double seconds) {
  if (seconds < 60.0) return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<std::int64_t>(std::llround(seconds));
  return fmt::format("{}:{:02} min", whole / 60, whole % 60);
}

int reportError(const Error& error) {
  fmt::print(stderr, "lambent: {}\n", error.line());
  return 1;
}

ProgressLine::ProgressLine(const Progress& progress) {
  if (::isatty(STDERR_FILENO) == 0) return;
  thread_ = std::jthread([&progress](std::stop_token stop) {
    std::mutex lock;
    std::condition_variable_any stopped;  // lets the end of a job come before the next tick
    std::unique_lock hold(lock);
    while (!stopped.wait_for(hold, stop, std::chrono::milliseconds(100),
                             [&] { return stop.stop_requested(); })) {
      if (const auto stage = progress.now(); !stage.name.empty())
        fmt::print(stderr, "\r\033[K{}", progressText(stage));
      std::fflush(stderr);
    }
    fmt::print(stderr, "\r\033[K");
  });
}

ProgressLine::~ProgressLine() = default;  // the jthread stops and joins

InterruptGuard::InterruptGuard(std::stop_source stop) {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGUSR1);  // the destructor wakes the thread with it
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  thread_ = std::jthread([signals, stop]() mutable {
    for (int interrupts = 0;; ++interrupts) {
      int signal = 0;
      if (sigwait(&signals, &signal) != 0 || signal == SIGUSR1) return;
      if (interrupts > 0) std::_Exit(130);
      if (::isatty(STDERR_FILENO) != 0)
        fmt::print(stderr, "\nlambent: stopping after the work in hand; interrupt again to end at once\n");
      stop.request_stop();
    }
  });
}

InterruptGuard::~InterruptGuard() {
  pthread_kill(thread_.native_handle(), SIGUSR1);
}

}  // namespace lambent::baker
