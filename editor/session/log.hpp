// Stores notices and errors for the log panel and for toasts. It is safe to use from any thread, because
// bakes and loaders report from theirs.
#pragma once

#include <chrono>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent::editor {

enum class Severity : std::uint8_t { Note, Warning, Error };

struct LogEntry {
  Severity severity = Severity::Note;
  std::string text;
  std::chrono::system_clock::time_point when;  // of the latest, if it was repeated
  std::uint32_t times = 1;                     // how often it was added in a row
  std::uint64_t number = 0;                    // increases from entry to entry
  // As a toast over the view: whether it still stands, since when (nothing: not yet), and for how many
  // frames.
  bool is_toast = true;
  std::optional<std::chrono::steady_clock::time_point> shown{};
  std::uint32_t frames = 0;
};

class Log {
 public:
  static constexpr std::size_t kMostEntries = 2000;  // beyond this the oldest entries are dropped

  void note(std::string text) { add(Severity::Note, std::move(text)); }
  void warn(std::string text) { add(Severity::Warning, std::move(text)); }
  void error(const lambent::Error& error) { add(Severity::Error, error.line()); }
  void add(Severity severity, std::string text);
  void clear();

  std::vector<LogEntry> entries() const;
  // Returns what stands over the view as toasts at this time, the latest last. Call it once for each frame: a
  // toast stays for some seconds, and for some frames where these take seconds.
  std::vector<LogEntry> toasts(std::chrono::steady_clock::time_point now);
  // Returns whether the last frame had toasts, or the next one will.
  bool hasToasts() const;
  std::uint64_t errors() const;

 private:
  mutable std::mutex lock_;
  std::deque<LogEntry> entries_;
  std::uint64_t next_ = 0, errors_ = 0;
};

}  // namespace lambent::editor
