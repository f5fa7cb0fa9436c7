// Stores notices and errors for the log panel. It is safe to use from any thread, because bakes and loaders
// report from theirs.
#pragma once

#include <chrono>
#include <deque>
#include <mutex>
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
  std::uint64_t errors() const;  // how many there were
  // Returns whether there were errors since the last call. They bring the log panel to the front.
  bool takeNewErrors();

 private:
  mutable std::mutex lock_;
  std::deque<LogEntry> entries_;
  std::uint64_t errors_ = 0, taken_ = 0;
};

}  // namespace lambent::editor
