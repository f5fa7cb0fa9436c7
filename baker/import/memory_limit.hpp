// Limits the memory of the program while a library reads a file that it does not check.
#pragma once

#include <cstdint>

#include <sys/resource.h>

namespace lambent::baker {

// While it lives, the program's address space grows by at most so many bytes, and an allocation beyond that
// throws std::bad_alloc. This holds for all threads, so `more_bytes` must leave them room; only one thread at
// a time has a limit. Where the system refuses a limit there is none.
class MemoryLimit {
 public:
  explicit MemoryLimit(std::uint64_t more_bytes);
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
  ::rlimit before_{};
  bool set_ = false;
};

}  // namespace lambent::baker
