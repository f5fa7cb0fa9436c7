// lambent-editor: opens, bakes and lights scenes. Exit codes: 0 done, 1 failed, 2 wrong usage.
#include <csignal>
#include <exception>

#include "editor/app/options.hpp"
#include "editor/app/run.hpp"
#include "runtime/gpu/out_of_memory.hpp"

int main(int argc, char** argv) {
  using namespace lambent;
  std::signal(SIGXFSZ, SIG_IGN);  // a file that grows past the user's limit is an error of that file
  try {
    const auto parsed = editor::parseOptions(argc, argv);
    if (const int* exit_code = std::get_if<int>(&parsed)) return *exit_code;
    const Result<void> done = editor::run(std::get<editor::Options>(parsed));
    if (done) return 0;
    editor::printError(done.error());
  } catch (const gpu::OutOfMemory& failure) {
    editor::printError(failure.error());
  } catch (const std::exception& error) {  // out of memory, mostly
    editor::printError({.subject = "stopped", .problem = error.what(), .hint = {}});
  }
  return 1;
}
