// The program lambent bakes glTF scenes into bundles of precomputed radiance transfer. Exit codes: 0 done, 1
// failed, 2 wrong usage.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "baker/cli/commands.hpp"

int main(int argc, char** argv) {
  CLI::App app("Bakes glTF scenes once, so that they can be lit any way you like in real time.", "lambent");
  app.require_subcommand(1);
  lambent::baker::Command run;
  lambent::baker::addBakeCommand(app, run);
  lambent::baker::addPlanCommand(app, run);
  lambent::baker::addInfoCommand(app, run);
  lambent::baker::addReferenceCommand(app, run);
  lambent::baker::addCompareCommand(app, run);
  const std::string version = std::string("lambent ") + LAMBENT_VERSION;
  app.set_version_flag("--version", version);
  for (CLI::App* command : app.get_subcommands({})) command->set_version_flag("--version", version);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {
    return app.exit(asked);  // --help, --version
  } catch (const CLI::ParseError& wrong) {
    fmt::print(stderr, "lambent: {}; see lambent --help\n", wrong.what());
    return 2;
  }
  try {
    return run();
  } catch (const std::exception& failure) {  // most likely out of memory
    fmt::print(stderr, "lambent: {}; free some memory or bake the scene in parts\n", failure.what());
    return 1;
  }
}
