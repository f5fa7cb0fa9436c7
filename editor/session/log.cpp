#include "editor/session/log.hpp"

#include <algorithm>
#include <utility>

namespace lambent::editor {

namespace {

constexpr std::chrono::seconds kToastAge{6};
constexpr std::uint32_t kToastFrames = 4;
constexpr std::size_t kMostToasts = 4;

}  // namespace

void Log::add(Severity severity, std::string text) {
  const auto now = std::chrono::system_clock::now();
  const std::lock_guard hold(lock_);
  if (severity == Severity::Error) ++errors_;
  if (!entries_.empty() && entries_.back().text == text && entries_.back().severity == severity) {
    LogEntry& last = entries_.back();
    last.when = now;
    ++last.times;
    last.is_toast = true, last.shown.reset(), last.frames = 0;
  } else {
    entries_.push_back({.severity = severity, .text = std::move(text), .when = now, .number = next_++});
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

std::vector<LogEntry> Log::toasts(std::chrono::steady_clock::time_point now) {
  const std::lock_guard hold(lock_);
  std::vector<LogEntry> shown;
  for (std::size_t i = entries_.size() - std::min(entries_.size(), kMostToasts); i < entries_.size(); ++i) {
    LogEntry& entry = entries_[i];
    const bool old = entry.shown && now - *entry.shown > kToastAge && entry.frames >= kToastFrames;
    entry.is_toast = entry.is_toast && !old;
    if (!entry.is_toast) continue;
    if (!entry.shown) entry.shown = now;
    ++entry.frames;
    shown.push_back(entry);
  }
  return shown;
}

bool Log::hasToasts() const {
  const std::lock_guard hold(lock_);
  const auto latest = static_cast<std::ptrdiff_t>(std::min(entries_.size(), kMostToasts));
  return std::any_of(entries_.end() - latest, entries_.end(), [](const LogEntry& e) { return e.is_toast; });
}

std::uint64_t Log::errors() const {
  const std::lock_guard hold(lock_);
  return errors_;
}

}  // namespace lambent::editor
