#include "runtime/base/standard_output.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace lambent {

Result<void> flushStandardOutput() {
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return {};
  const int why = errno;
  return fail("standard output",
              std::string("cannot be written") + (why != 0 ? std::string(": ") + std::strerror(why) : ""),
              "free some space or send it elsewhere");
}

}  // namespace lambent
