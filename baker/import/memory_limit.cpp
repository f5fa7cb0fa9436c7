#include "baker/import/memory_limit.hpp"

#include <algorithm>
#include <mutex>

#include "runtime/base/process.hpp"

namespace lambent::baker {

namespace {

std::mutex& oneAtATime() {
  static std::mutex mutex;
  return mutex;
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
