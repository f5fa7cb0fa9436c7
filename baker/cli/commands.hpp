// The subcommands of `lambent`, each in a file of its own: adds itself to the command line and says what to
// run.
#pragma once

#include <functional>
#include <string_view>

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

// Options of a bake, by the table of their rows (baker/bake/option_rows.hpp): all of them, or one by name.
void addBakeOptions(CLI::App& command, BakeOptions& options);
void addBakeOption(CLI::App& command, std::string_view name, BakeOptions& options);

}  // namespace lambent::baker
