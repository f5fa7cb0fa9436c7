// The room baker/cli is the program `lambent`: it bakes, plans, inspects, compares, and draws references.
// Each subcommand is a file of its own that adds itself to the command line and says what to run. Words of
// the command line come in; bundles, pictures and reports go out. Commands run on the main thread, and errors
// end in one line on stderr.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include <nlohmann/json_fwd.hpp>

#include "baker/bake/bake.hpp"
#include "baker/jobs/progress.hpp"
#include "baker/pipeline/whole_progress.hpp"
#include "runtime/base/result.hpp"

namespace CLI {
class App;
}

namespace lambent::baker {

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

// These return texts such as "1.2 M", "3.4 MiB" and "1:02".
std::string countText(double count);
std::string bytesText(double bytes);
std::string durationText(double seconds);

// Print "lambent: SUBJECT: PROBLEM; MEND" to stderr and return the exit code: 1, or 2 for wrong usage.
int reportError(const Error& error);
int wrongUsage(const Error& error);

// Prints "lambent: SUBJECT: SENTENCE" to stderr, for what a user should know though it is no error.
void reportNotice(const std::filesystem::path& subject, const std::string& sentence);

// How much a command says beside its result.
struct SayOptions {
  enum class Progress : std::uint8_t { Text, Json, Off };
  bool quiet = false;  // no progress and no summary, but errors, warnings and what --json asks for
  std::optional<Progress> progress;  // nothing: text, or off if quiet
  std::string label;                 // stands before the line of text
};

// These add --quiet and --progress to a command.
void addQuiet(CLI::App& command, SayOptions& say);
void addProgress(CLI::App& command, SayOptions& say);

// Follows `progress` on stderr while it lives: the share of the whole, the stage, its rate and the time left.
// As text, a terminal has one line that changes, and a log file gets a line every ten seconds. As JSON it is
// an object a line each second, for other programs (docs/baking.md). `seen_as` knows what stages will take.
class ProgressLine {
 public:
  ProgressLine(const Progress& progress, WholeProgress seen_as, const SayOptions& say,
               std::filesystem::path scene);
  ~ProgressLine();

 private:
  bool terminal_ = false;
  std::jthread watch_;
};

// These print what a bake came to, as text or as JSON (bake_report.cpp).

struct FinishedBake {
  const std::filesystem::path& output;
  const BakeOptions& options;
  const BakeReport& report;
};

// Returns what the bake measured of its pictures' error, as a sentence's end and as JSON, which is null if
// nothing was measured.
std::string pictureErrorText(const bundle::PictureError& error);
nlohmann::json pictureErrorJson(const std::optional<bundle::PictureError>& error);

// Returns whether a bound on the error, or a limit, was missed.
bool missesBound(const FinishedBake& bake);

// Says in its last line if a bound is missed, and what would help.
void printReport(const FinishedBake& bake);
nlohmann::json reportJson(const FinishedBake& bake);

// While it lives, SIGINT and SIGTERM ask `stop` to stop, and a second one ends the program at once. Construct
// it before any thread, so that all of them inherit the blocked signals.
class InterruptGuard {
 public:
  explicit InterruptGuard(std::stop_source stop);
  ~InterruptGuard();

 private:
  std::jthread thread_;
};

}  // namespace lambent::baker
