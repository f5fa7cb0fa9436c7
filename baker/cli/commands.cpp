#include "baker/cli/commands.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <map>
#include <span>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <pthread.h>
#include <unistd.h>

namespace lambent::baker {

namespace {

constexpr std::chrono::milliseconds kTerminalEvery{100}, kJsonEvery{1000}, kLogEvery{10'000};

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

std::string progressJson(const WholeProgress::Seen& seen, const std::filesystem::path& scene) {
  const nlohmann::json json = {{"scene", scene.string()},          {"share", seen.share},
                               {"secondsLeft", seen.seconds_left}, {"stage", seen.stage.name},
                               {"done", seen.stage.done},          {"total", seen.stage.total},
                               {"unit", seen.stage.unit},          {"unitsPerSecond", seen.units_per_s}};
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
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

int wrongUsage(const Error& error) {
  reportError(error);
  return 2;
}

void reportNotice(const std::filesystem::path& subject, const std::string& sentence) {
  fmt::print(stderr, "lambent: {}\n", Error{subject.string(), sentence, {}}.line());
}

void addQuiet(CLI::App& command, SayOptions& say) {
  command.add_flag("-q,--quiet", say.quiet, "Print errors and warnings only, and what --json prints");
}

void addProgress(CLI::App& command, SayOptions& say) {
  static const std::map<std::string, SayOptions::Progress> kStyles = {{"text", SayOptions::Progress::Text},
                                                                      {"json", SayOptions::Progress::Json},
                                                                      {"off", SayOptions::Progress::Off}};
  command
      .add_option_function<std::string>(
          "--progress", [&say](const std::string& word) { say.progress = kStyles.at(word); },
          "How stderr says how far it is. text (default): a line that changes, and in a file one every ten "
          "seconds; json: one object a line each second, for programs")
      ->check(CLI::IsMember(kStyles).description(""))
      ->type_name("text|json|off");
}

ProgressLine::ProgressLine(const Progress& progress, WholeProgress seen_as, const SayOptions& say,
                           std::filesystem::path scene) {
  const auto style =
      say.progress.value_or(say.quiet ? SayOptions::Progress::Off : SayOptions::Progress::Text);
  if (style == SayOptions::Progress::Off) return;
  const bool json = style == SayOptions::Progress::Json;
  terminal_ = !json && ::isatty(STDERR_FILENO) != 0;
  const auto every = terminal_ ? kTerminalEvery : json ? kJsonEvery : kLogEvery;
  const auto print = [json, terminal = terminal_, label = say.label,
                      scene = std::move(scene)](const WholeProgress::Seen& seen) {
    if (seen.stage.name.empty()) return;
    if (json)
      fmt::print(stderr, "{}\n", progressJson(seen, scene));
    else
      fmt::print(stderr, "{}{}{}{}", terminal ? "\r\033[K" : "lambent: ", label, progressText(seen),
                 terminal ? "" : "\n");
    std::fflush(stderr);
  };
  if (json) print(seen_as.look(progress));  // so that a program learns at once what is baked
  watch_ = watchProgress(progress, std::move(seen_as), every, print, /*at_end=*/false);
}

ProgressLine::~ProgressLine() {
  watch_ = {};  // ends it
  if (terminal_) fmt::print(stderr, "\r\033[K");
}

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
