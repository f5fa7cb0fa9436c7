#include "editor/session/log.hpp"

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
    entries_.back().when = now;
    ++entries_.back().times;
    std::erase_if(toasts_, [&](const Toast& toast) { return toast.number == entries_.back().number; });
  } else {
    entries_.push_back({severity, std::move(text), now, 1, next_++});
  }
  toasts_.push_back({.number = entries_.back().number});
  if (toasts_.size() > kMostToasts) toasts_.pop_front();
  if (entries_.size() > kMostEntries) entries_.pop_front();
}

void Log::clear() {
  const std::lock_guard hold(lock_);
  entries_.clear();
  toasts_.clear();
}

std::vector<LogEntry> Log::entries() const {
  const std::lock_guard hold(lock_);
  return {entries_.begin(), entries_.end()};
}

std::vector<LogEntry> Log::toasts(std::chrono::steady_clock::time_point now) {
  const std::lock_guard hold(lock_);
  std::erase_if(toasts_, [&](const Toast& toast) {
    return toast.shown && now - *toast.shown > kToastAge && toast.frames >= kToastFrames;
  });
  std::vector<LogEntry> shown;
  for (Toast& toast : toasts_) {
    if (!toast.shown) toast.shown = now;
    ++toast.frames;
    for (const LogEntry& entry : entries_)
      if (entry.number == toast.number) shown.push_back(entry);
  }
  return shown;
}

bool Log::hasToasts() const {
  const std::lock_guard hold(lock_);
  return !toasts_.empty();
}

std::uint64_t Log::errors() const {
  const std::lock_guard hold(lock_);
  return errors_;
}

}  // namespace lambent::editor
