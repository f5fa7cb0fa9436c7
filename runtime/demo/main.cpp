#include <csignal>
#include <cstdio>
#include <exception>

#include <fmt/format.h>

#include "runtime/base/atomic_file.hpp"
#include "runtime/base/process.hpp"
#include "runtime/demo/stage.hpp"
#include "runtime/gpu/objects.hpp"

int main(int argc, char** argv) {
  using namespace lambent;
  std::signal(SIGXFSZ, SIG_IGN);  // a file that grows past the user's limit is an error of that file
  try {
    const auto parsed = demo::parseOptions(argc, argv);
    if (const int* exit_code = std::get_if<int>(&parsed)) return *exit_code;
    const auto& options = std::get<demo::Options>(parsed);
    for (const std::filesystem::path& bundle : options.bundles)
      if (const auto checked = checkRegularFile(bundle, "a bundle (.lmb.glb)"); !checked) {
        demo::printError(checked.error());
        return 1;
      }
    if (options.default_light)
      fmt::print(stderr, "lambent-demo: no --light given; showing {}\n",
                 fmt::join(options.light_words, " and "));
    Result<void> done = options.headless ? demo::runHeadless(options) : demo::runWindowed(options);
    if (done) done = flushStandardOutput();
    if (done) return 0;
    demo::printError(done.error());
  } catch (const gpu::OutOfMemory& failure) {
    demo::printError(failure.error());
  } catch (const std::exception& error) {  // mostly out of memory
    demo::printError({.subject = "stopped", .problem = error.what(), .hint = {}});
  }
  return 1;
}
