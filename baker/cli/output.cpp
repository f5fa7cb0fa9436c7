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

constexpr std::chrono::milliseconds kLogEvery = std::chrono::seconds(10);

std::string scaled(double value, double base, std::span<const char* const> units) {
  std::size_t unit = 0;
  for (; value >= base && unit + 1 < units.size(); ++unit) value /= base;
  return fmt::format("{:.{}f} {}", value, unit == 0 ? 0 : 1, units[unit]);
}

// Returns a line such as "37 %  direct light, 1.2 M samples/s, about 12.0 s left".
std::string progressText(const WholeProgress::Seen& seen) {
  std::string text = fmt::format("{:3.0f} %  {}", 100.0 * seen.share, seen.stage.name);
  if (seen.units_per_s > 0.0) text += fmt::format(", {} {}/s", countText(seen.units_per_s), seen.stage.unit);
  if (seen.seconds_left > 0.0) text += fmt::format(", about {} left", durationText(seen.seconds_left));
  return text;
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

std::optional<Cache> openCache(const std::string& folder, std::uint64_t most_bytes) {
  if (folder == "off") return std::nullopt;
  const std::filesystem::path path = folder.empty() ? Cache::defaultFolder() : std::filesystem::path(folder);
  if (path.empty()) return std::nullopt;
  auto cache = Cache::open(path, most_bytes);
  if (cache) return std::move(*cache);
  fmt::print(stderr, "lambent: {}; going on without it\n", cache.error().line());
  return std::nullopt;
}

int reportError(const Error& error) {
  fmt::print(stderr, "lambent: {}\n", error.line());
  return 1;
}

void reportNotice(const std::filesystem::path& subject, const std::string& sentence) {
  fmt::print(stderr, "lambent: {}\n", Error{subject.string(), sentence, {}}.line());
}

ProgressLine::ProgressLine(const Progress& progress, WholeProgress seen_as) {
  thread_ = std::jthread([&progress, whole = std::move(seen_as)](std::stop_token stop) mutable {
    const bool terminal = ::isatty(STDERR_FILENO) != 0;
    const auto every = terminal ? std::chrono::milliseconds(100) : kLogEvery;
    std::mutex lock;
    std::condition_variable_any stopped;  // lets the end of a job come before the next tick
    std::unique_lock hold(lock);
    while (!stopped.wait_for(hold, stop, every, [&] { return stop.stop_requested(); })) {
      if (const auto seen = whole.look(progress); !seen.stage.name.empty())
        fmt::print(stderr, "{}{}{}", terminal ? "\r\033[K" : "lambent: ", progressText(seen),
                   terminal ? "" : "\n");
      std::fflush(stderr);
    }
    if (terminal) fmt::print(stderr, "\r\033[K");
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
