#include "baker/import/memory_limit.hpp"

#include <algorithm>
#include <fstream>
#include <mutex>

#include <unistd.h>

namespace lambent::baker {

namespace {

std::mutex& oneAtATime() {
  static std::mutex mutex;
  return mutex;
}

// Returns 0 if the system does not say it.
std::uint64_t addressSpaceBytes() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t pages = 0;
  const long page_bytes = ::sysconf(_SC_PAGESIZE);
  return statm >> pages && page_bytes > 0 ? pages * static_cast<std::uint64_t>(page_bytes) : 0;
}

}  // namespace

MemoryLimit::MemoryLimit(std::uint64_t more_bytes) {
  oneAtATime().lock();
  const std::uint64_t now = addressSpaceBytes();
  if (now == 0 || ::getrlimit(RLIMIT_AS, &before_) != 0) return;
  ::rlimit limit = before_;
  limit.rlim_cur = std::min<::rlim_t>(before_.rlim_cur, now + more_bytes);
  set_ = ::setrlimit(RLIMIT_AS, &limit) == 0;
}

MemoryLimit::~MemoryLimit() {
  if (set_) ::setrlimit(RLIMIT_AS, &before_);
  oneAtATime().unlock();
}

}  // namespace lambent::baker
