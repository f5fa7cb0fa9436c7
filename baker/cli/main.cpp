// The program lambent bakes glTF scenes into bundles of precomputed radiance transfer. Exit codes: 0 done, 1
// failed, 2 wrong usage.
#include <csignal>
#include <cstdlib>
#include <exception>
#include <new>
#include <system_error>

#include <CLI/CLI.hpp>

#include "baker/cli/commands.hpp"
#include "runtime/base/process.hpp"
#include "runtime/command_line/help.hpp"

namespace lambent::baker {

namespace {

int runToItsEnd(const Command& run) {
  try {
    const int code = run();
    if (const auto printed = flushStandardOutput(); !printed) return reportError(printed.error());
    return code;
  } catch (const std::bad_alloc&) {
    return reportError({"memory", "is used up", "free some or bake the scene in parts"});
  } catch (const std::system_error& failure) {  // printing and starting threads throw it
    if (const auto printed = flushStandardOutput(); !printed) return reportError(printed.error());
    return reportError(
        {"the system", failure.what(), "see how many threads and files it allows (ulimit -a)"});
  } catch (const std::exception& failure) {
    return reportError({"stopped", failure.what(), "please report this scene"});
  }
}

// Libraries end the program where an exception cannot leave a function of theirs, most often because a thread
// or memory is not to be had.
[[noreturn]] void endInOneLine() {
  reportError(
      {"a library", "cannot go on", "free some memory, or see how many threads there may be (ulimit -a)"});
  std::_Exit(1);
}

}  // namespace

}  // namespace lambent::baker

int main(int argc, char** argv) {
  using namespace lambent;
  // A file that grows past its limit is an error of writing, which says what to do, and not a death.
  std::signal(SIGXFSZ, SIG_IGN);
  std::set_terminate(baker::endInOneLine);
  CLI::App app("Bakes glTF scenes once, so that they can be lit any way you like in real time.", "lambent");
  app.require_subcommand(1);
  baker::Command run;
  baker::addBakeCommand(app, run);
  baker::addPlanCommand(app, run);
  baker::addInfoCommand(app, run);
  baker::addViewCommand(app, run);
  baker::addReferenceCommand(app, run);
  baker::addCompareCommand(app, run);
  baker::addAccuracyCommand(app, run);
  baker::addExportCommand(app, run);
  command_line::addExamples(app, {{"lambent bake scene.gltf", "bakes a scene to scene.lmb.glb"},
                                  {"lambent info scene.lmb.glb", "checks it and says what is in it"},
                                  {"lambent bake --help", "lists the options of a command"}});
  command_line::finish(app, "lambent " LAMBENT_VERSION);
  if (const auto ended = command_line::parse(app, argc, argv)) return *ended;
  return baker::runToItsEnd(run);
}
