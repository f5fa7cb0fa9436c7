#include "baker/pipeline/journal.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "runtime/base/atomic_file.hpp"

namespace lambent::baker {

namespace {

namespace fs = std::filesystem;

constexpr const char* kEntry = ".json";
constexpr const char* kLock = ".lock";

fs::path lockOf(const fs::path& entry) {
  return fs::path(entry).replace_extension(kLock);
}

constexpr int kTaken = -1, kUnwritable = -2;

// Locks an entry and returns the file, kTaken if another process has it, or kUnwritable if there can be no
// such file. The holder of a lock may remove the file, so this tries again until the locked file is the one
// that has the name.
int lock(const fs::path& entry) {
  const fs::path path = lockOf(entry);
  for (int attempt = 0; attempt < 16; ++attempt) {
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file < 0) return kUnwritable;
    struct stat held {
    }, named{};
    errno = 0;
    if (::flock(file, LOCK_EX | LOCK_NB) == 0 && ::fstat(file, &held) == 0 &&
        ::stat(path.c_str(), &named) == 0 && held.st_ino == named.st_ino && held.st_dev == named.st_dev)
      return file;
    const bool taken = errno == EWOULDBLOCK;
    ::close(file);
    if (taken) return kTaken;
  }
  return kTaken;
}

void unlock(const fs::path& entry, int file) {
  ::unlink(lockOf(entry).c_str());
  ::close(file);
}

void removeEntry(const fs::path& entry) {
  std::error_code ignored;
  fs::remove(entry, ignored);
}

}  // namespace

Journal::Entry::Entry(Entry&& other) noexcept
    : file_(std::exchange(other.file_, {})),
      lock_(std::exchange(other.lock_, -1)),
      error_(std::move(other.error_)) {}

Journal::Entry& Journal::Entry::operator=(Entry&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(lock_, other.lock_);
  std::swap(error_, other.error_);
  return *this;
}

Journal::Entry::~Entry() {
  if (lock_ >= 0) unlock(file_, lock_);
}

void Journal::Entry::done() {
  if (lock_ < 0) return;
  removeEntry(file_);
  unlock(file_, std::exchange(lock_, -1));
}

Journal::Entry Journal::begin(const BakeRequest& request) const {
  Entry entry;
  if (folder_.empty()) return entry;
  std::error_code failed;
  fs::create_directories(folder_, failed);
  if (failed) {
    entry.error_ = Error{folder_.string(), "cannot be made: " + failed.message(), {}};
    return entry;
  }
  const fs::path path = folder_ / (requestKey(request) + kEntry);
  int held = lock(path);
  // A process in unfinished() holds the lock for a moment only.
  for (int attempt = 0; held == kTaken && attempt < 10; ++attempt) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    held = lock(path);
  }
  if (held == kUnwritable) entry.error_ = Error{folder_.string(), "cannot be written to", {}};
  if (held < 0) return entry;
  entry.file_ = path;
  entry.lock_ = held;
  const Result<void> written = [&]() -> Result<void> {
    auto file = AtomicFile::open(path);
    if (!file) return failAgain(file.error());
    if (auto wrote = file->write(requestText(request)); !wrote) return wrote;
    return file->commit();
  }();
  if (!written) entry.error_ = written.error();
  return entry;
}

std::vector<BakeRequest> Journal::unfinished() const {
  if (folder_.empty()) return {};
  struct Found {
    fs::file_time_type begun;
    BakeRequest request;
  };
  std::vector<Found> found;
  std::error_code failed;
  for (fs::directory_iterator at(folder_, failed), end; !failed && at != end; at.increment(failed)) {
    const fs::path path = at->path();
    if (path.extension() != kEntry) continue;
    const int held = lock(path);
    if (held < 0) continue;
    // This is read under the lock, since the previous holder may have finished just now.
    std::error_code gone;
    const fs::file_time_type begun = fs::last_write_time(path, gone);
    const auto text = readTextFile(path);
    if (const auto request = text ? readRequest(*text) : std::nullopt; request && !gone)
      found.push_back({begun, *request});
    unlock(path, held);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Found& a, const Found& b) { return a.begun < b.begun; });
  std::vector<BakeRequest> requests;
  for (Found& each : found) requests.push_back(std::move(each.request));
  return requests;
}

void Journal::forget(const BakeRequest& request) const {
  if (folder_.empty()) return;
  const fs::path path = folder_ / (requestKey(request) + kEntry);
  if (const int held = lock(path); held >= 0) {
    removeEntry(path);
    unlock(path, held);
  }
}

}  // namespace lambent::baker
