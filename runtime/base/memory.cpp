#include "runtime/base/memory.hpp"

#include <fstream>

#if __has_include(<malloc.h>)
#include <malloc.h>
#endif
#include <sys/resource.h>
#include <unistd.h>

namespace lambent {

namespace {

struct Pages {
  std::uint64_t reserved = 0, resident = 0;
};

Pages pagesNow() {
  std::ifstream file("/proc/self/statm");
  Pages pages;
  file >> pages.reserved >> pages.resident;
  return pages;
}

std::uint64_t bytesOf(std::uint64_t pages) {
  const long page_bytes = ::sysconf(_SC_PAGESIZE);
  return page_bytes > 0 ? pages * static_cast<std::uint64_t>(page_bytes) : 0;
}

}  // namespace

std::uint64_t addressSpaceBytes() {
  return bytesOf(pagesNow().reserved);
}

std::uint64_t residentBytes() {
  return bytesOf(pagesNow().resident);
}

std::uint64_t peakBytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::uint64_t{1024} * static_cast<std::uint64_t>(usage.ru_maxrss);
}

void returnFreedMemory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

std::uint64_t machineBytes() {
  const long pages = ::sysconf(_SC_PHYS_PAGES);
  return pages > 0 ? bytesOf(static_cast<std::uint64_t>(pages)) : 0;
}

}  // namespace lambent
