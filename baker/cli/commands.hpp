// The room baker/cli is the program `lambent`: it bakes, plans, inspects, compares, and draws references.
// Each subcommand is a file of its own that adds itself to the command line and says what to run. Words of
// the command line come in; bundles, pictures and reports go out. Commands run on the main thread, and errors
// end in one line on stderr.
#pragma once

#include <functional>
#include <string_view>

namespace CLI {
class App;
}

namespace lambent::baker {

struct BakeOptions;

// A command returns the exit code: 0 done, 1 failed.
using Command = std::function<int()>;

// Each adds its subcommand and sets `run` if the user chose it.
void addBakeCommand(CLI::App& app, Command& run);
void addPlanCommand(CLI::App& app, Command& run);
void addInfoCommand(CLI::App& app, Command& run);
void addReferenceCommand(CLI::App& app, Command& run);
void addCompareCommand(CLI::App& app, Command& run);
void addAccuracyCommand(CLI::App& app, Command& run);
void addExportCommand(CLI::App& app, Command& run);
void addViewCommand(CLI::App& app, Command& run);

// Adds the options of a bake from their table (baker/bake/options.hpp).
void addBakeOptions(CLI::App& command, BakeOptions& options);

}  // namespace lambent::baker
