#include "editor/session/log.hpp"

#include <utility>

namespace lambent::editor {

void Log::add(Severity severity, std::string text) {
  const auto now = std::chrono::system_clock::now();
  const std::lock_guard hold(lock_);
  if (severity == Severity::Error) ++errors_;
  if (!entries_.empty() && entries_.back().text == text && entries_.back().severity == severity) {
    entries_.back().when = now;
    ++entries_.back().times;
    return;
  }
  entries_.push_back({severity, std::move(text), now, 1, next_++});
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

std::vector<LogEntry> Log::recent(std::chrono::milliseconds age) const {
  const auto since = std::chrono::system_clock::now() - age;
  const std::lock_guard hold(lock_);
  std::vector<LogEntry> fresh;
  for (const LogEntry& entry : entries_)
    if (entry.when > since) fresh.push_back(entry);
  return fresh;
}

std::uint64_t Log::errors() const {
  const std::lock_guard hold(lock_);
  return errors_;
}

}  // namespace lambent::editor
