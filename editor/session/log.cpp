#include "editor/session/log.hpp"

#include <utility>

namespace lambent::editor {

void Log::add(Severity severity, std::string text) {
  const auto now = std::chrono::system_clock::now();
  const std::lock_guard hold(lock_);
  if (severity == Severity::Error) ++errors_;
  if (!entries_.empty() && entries_.back().text == text && entries_.back().severity == severity) {
    LogEntry& last = entries_.back();
    last.when = now;
    ++last.times;
  } else {
    entries_.push_back({.severity = severity, .text = std::move(text), .when = now});
  }
  if (entries_.size() > kMostEntries) entries_.pop_front();
}

void Log::clear() {
  const std::lock_guard hold(lock_);
  entries_.clear();
}

std::vector<LogEntry> Log::entries() const {
  const std::lock_guard hold(lock_);
  return {entries_.begin(), entries_.end()};
}

std::uint64_t Log::errors() const {
  const std::lock_guard hold(lock_);
  return errors_;
}

bool Log::takeNewErrors() {
  const std::lock_guard hold(lock_);
  return std::exchange(taken_, errors_) != errors_;
}

}  // namespace lambent::editor
