// The subcommands of `lambent`, each in a file of its own: adds itself to the command line and says what to
// run.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace lambent::baker {

struct BakeOptions;

// Returns the exit code: 0 done, 1 failed.
using Command = std::function<int()>;

// Each adds its subcommand; `run` is set when it was chosen.
void addBakeCommand(CLI::App& app, Command& run);
void addPlanCommand(CLI::App& app, Command& run);
void addInfoCommand(CLI::App& app, Command& run);
void addReferenceCommand(CLI::App& app, Command& run);
void addCompareCommand(CLI::App& app, Command& run);

// --volume-grid of bake; --light-samples of bake and plan.
void addVolumeGridOption(CLI::App& command, BakeOptions& options);
void addLightSamplesOption(CLI::App& command, BakeOptions& options);
void addNeighborhoodGridOption(CLI::App& command, BakeOptions& options);

}  // namespace lambent::baker
