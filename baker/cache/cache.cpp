#include "baker/cache/cache.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <mutex>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "baker/cache/entry_file.hpp"

namespace lambent::baker {

namespace fs = std::filesystem;

namespace {

constexpr const char* kExtension = ".entry";
// Eviction frees a tenth of the cache at a time, so that a full one is not listed for every entry.
constexpr double kLeftAfterEviction = 0.9;
// A file that has been in the process of being written for this long was left by a killed program.
constexpr std::int64_t kAbandoned_ns = std::int64_t{3600} * 1'000'000'000;

std::int64_t now_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

struct Listed {
  fs::path path;
  std::uint64_t bytes = 0;
  std::int64_t used_ns = 0;
};

// Lists the entries, oldest first. Removes files that killed programs left half written.
std::vector<Listed> list(const fs::path& folder) {
  std::vector<Listed> entries;
  std::error_code code;
  for (auto at = fs::recursive_directory_iterator(folder, code); !code && at != fs::end(at);
       at.increment(code)) {
    struct stat status {};
    if (::stat(at->path().c_str(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
    const std::int64_t used_ns = std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec;
    if (at->path().extension() == kExtension)
      entries.push_back({at->path(), static_cast<std::uint64_t>(status.st_size), used_ns});
    else if (at->path().filename().string().find(std::string(kExtension) + kPartMark) != std::string::npos &&
             now_ns() - used_ns > kAbandoned_ns)
      ::unlink(at->path().c_str());
  }
  std::sort(entries.begin(), entries.end(), [](const Listed& a, const Listed& b) {
    return a.used_ns != b.used_ns ? a.used_ns < b.used_ns : a.path < b.path;
  });
  return entries;
}

}  // namespace

struct Cache::State {
  fs::path folder;
  std::uint64_t most_bytes = 0;
  std::atomic<std::int64_t> bake_began_ns = 0, checkpoint_ns = 0;
  std::atomic<double> checkpoint_every_s = kCheckpointEvery_s;
  std::atomic<bool> reading = true, writing = true;
  mutable std::atomic<std::uint64_t> found = 0, bytes_read = 0, stored = 0, bytes_written = 0, damaged = 0,
                                     evicted = 0;

  mutable std::mutex lock;             // protects the members below
  std::optional<std::uint64_t> bytes;  // size of the folder as far as known; other processes add to it
  std::uint64_t room_at = 0;           // size from which eviction begins
  std::string notice;

  fs::path pathOf(const Key& key) const {
    const std::string hex = key.hex();
    return folder / hex.substr(0, 2) / (hex.substr(2) + kExtension);
  }
  void makeRoom();
};

// Must be called with the lock held.
void Cache::State::makeRoom() {
  std::vector<Listed> entries = list(folder);
  std::uint64_t sum = 0;
  for (const Listed& entry : entries) sum += entry.bytes;
  const auto wanted = static_cast<std::uint64_t>(kLeftAfterEviction * static_cast<double>(most_bytes));
  for (const Listed& entry : entries) {
    if (sum <= wanted || entry.used_ns >= bake_began_ns) break;
    if (::unlink(entry.path.c_str()) != 0) continue;
    sum -= entry.bytes;
    ++evicted;
  }
  bytes = sum;
  // If all entries are in use, looking again after the next entry would be too early.
  room_at = std::max(most_bytes, sum + most_bytes / 10);
}

fs::path Cache::defaultFolder() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return fs::path(value ? value : "");
  };
  if (const fs::path own = variable("LAMBENT_CACHE"); !own.empty()) return own == "off" ? fs::path() : own;
  // Relative paths do not count (XDG Base Directory Specification).
  if (const fs::path caches = variable("XDG_CACHE_HOME"); caches.is_absolute()) return caches / "lambent";
  if (const fs::path home = variable("HOME"); !home.empty()) return home / ".cache" / "lambent";
  return {};
}

Result<Cache> Cache::open(const fs::path& folder, std::uint64_t most_bytes) {
  std::error_code code, unreachable;
  fs::create_directories(folder, code);
  if (!fs::is_directory(folder, unreachable))
    return fail(folder.string(), "cannot be made a cache: " + (code ? code.message() : "it is no folder"),
                "name another folder with --cache, or --cache off");
  auto state = std::make_unique<State>();
  state->folder = folder;
  state->most_bytes = most_bytes;
  Cache cache(std::move(state));
  cache.beginBake();
  return cache;
}

Cache::Cache(std::unique_ptr<State> state) : state_(std::move(state)) {}
Cache::Cache(Cache&&) noexcept = default;
Cache& Cache::operator=(Cache&&) noexcept = default;
Cache::~Cache() = default;

std::optional<std::vector<std::byte>> Cache::find(const Key& key) const {
  if (!state_->reading) return std::nullopt;
  const fs::path path = state_->pathOf(key);
  const auto file = readAndTouch(path);
  if (!file) return std::nullopt;
  auto bytes = unpackEntry(key, *file);
  if (!bytes) {
    ++state_->damaged;
    ::unlink(path.c_str());
    return std::nullopt;
  }
  ++state_->found;
  state_->bytes_read += file->size();
  return bytes;
}

bool Cache::has(const Key& key) const {
  return state_->reading && ::access(state_->pathOf(key).c_str(), R_OK) == 0;
}

void Cache::put(const Key& key, std::span<const std::byte> bytes) {
  if (!state_->writing) return;
  const std::vector<std::byte> file = packEntry(key, bytes);
  const fs::path path = state_->pathOf(key);
  std::error_code ignored;  // the error shows when the file is written
  fs::create_directory(path.parent_path(), ignored);
  const auto written = writeBeside(path, file);
  const std::lock_guard hold(state_->lock);
  if (!written) {
    state_->writing = false;
    if (state_->notice.empty())
      state_->notice = "cache: " + written.error().line() + "; the bake goes on and keeps nothing more in it";
    return;
  }
  ++state_->stored;
  state_->bytes_written += file.size();
  if (state_->bytes) *state_->bytes += file.size();
  if (!state_->bytes || *state_->bytes > state_->room_at) state_->makeRoom();
}

void Cache::drop(const Key& key) {
  ::unlink(state_->pathOf(key).c_str());
}

void Cache::beginBake() {
  state_->bake_began_ns = now_ns();
  checkpointed();
}

void Cache::setReading(bool reading) {
  state_->reading = reading;
}

void Cache::setCheckpointEvery(double seconds) {
  state_->checkpoint_every_s = seconds;
}

double Cache::checkpointEvery() const {
  return state_->checkpoint_every_s;
}

bool Cache::checkpointDue() const {
  return static_cast<double>(now_ns() - state_->checkpoint_ns) * 1e-9 >= state_->checkpoint_every_s;
}

void Cache::checkpointed() {
  state_->checkpoint_ns = now_ns();
}

const fs::path& Cache::folder() const {
  return state_->folder;
}

CacheFigures Cache::figures() const {
  return {.found = state_->found,
          .bytes_read = state_->bytes_read,
          .stored = state_->stored,
          .bytes_written = state_->bytes_written,
          .damaged = state_->damaged,
          .evicted = state_->evicted};
}

std::string Cache::notice() const {
  const std::lock_guard hold(state_->lock);
  return state_->notice;
}

}  // namespace lambent::baker
