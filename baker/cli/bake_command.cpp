// Implements lambent bake SCENE [-o OUT.lmb.glb], --watch DIR, --resume. SCENE may be a folder.
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/bake/option_rows.hpp"
#include "baker/cli/bake_report.hpp"
#include "baker/cli/bake_scene.hpp"
#include "baker/cli/commands.hpp"
#include "baker/cli/output.hpp"
#include "baker/pipeline/journal.hpp"
#include "baker/pipeline/source_watch.hpp"
#include "baker/plan/counted.hpp"
#include "runtime/command_line/help.hpp"

namespace lambent::baker {

// Adds the options of a bake to the command line. The library parses the words, and the table of options says
// what they mean.

namespace {

CLI::Option* add(CLI::App& command, std::string_view name, const OptionRow& row, BakeOptions& options) {
  return command_line::addWord(command, "--" + std::string(name), std::string(row.kind), row.help,
                               [&options, &row](const std::string& word) { return row.put(options, word); });
}

}  // namespace

void addBakeOptions(CLI::App& command, BakeOptions& options) {
  for (const OptionRow& row : optionRows()) {
    CLI::Option* option = add(command, row.name, row, options)->group(std::string(row.group));
    if (row.shows_default) option->default_str(row.word(BakeOptions{}));
    if (!row.former.empty()) add(command, row.former, row, options)->group("");  // hidden in the help
  }
}

namespace {

namespace fs = std::filesystem;

double secondsSince(std::chrono::steady_clock::time_point begun) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

// Counts and prints what came of each scene.
class FolderReport {
 public:
  explicit FolderReport(const BakeArguments& arguments) : arguments_(arguments) {}

  void failed(const fs::path& scene, const Error& error) {
    ++failed_;
    // Errors of options and outputs do not name the scene.
    reportError(error.subject == scene.string() ? error : Error{scene.string(), error.line(), {}});
    json_.push_back({{"scene", scene.string()}, {"error", error.line()}});
  }
  void baked(const BakeArguments& one, const BakeOutcome& outcome, double seconds) {
    ++(outcome ? baked_ : up_to_date_);
    missed_ |= failsStrictly(one, outcome);
    if (!arguments_.json) {
      say("{}: {}", one.scene.string(),
          outcome ? fmt::format("{} in {}, {}", one.output.string(), durationText(seconds),
                                bytesText(static_cast<double>(outcome->file_bytes)))
                  : one.output.string() + " is up to date");
      return;
    }
    json_.push_back(outcomeJson(one, outcome));
    json_.back()["scene"] = one.scene.string();
  }
  // Prints the last line, or the array, and returns the exit code.
  int end(std::size_t scenes) const {
    const std::size_t missing = scenes - baked_ - up_to_date_ - failed_;
    if (arguments_.json)
      fmt::print("{}\n", json_.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    else
      say("{}: {} baked, {} up to date, {} failed{} in {}", counted(scenes, "scene"), baked_, up_to_date_,
          failed_, missing > 0 ? fmt::format(", {} not begun", missing) : "",
          durationText(secondsSince(begun_)));
    return failed_ + missing > 0 || missed_ ? 1 : 0;
  }

 private:
  template <class... Words>
  void say(fmt::format_string<Words...> text, Words&&... words) const {
    if (arguments_.say.quiet) return;
    fmt::print("{}\n", fmt::format(text, std::forward<Words>(words)...));
    std::fflush(stdout);
  }

  const BakeArguments& arguments_;
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
  std::size_t baked_ = 0, up_to_date_ = 0, failed_ = 0;
  bool missed_ = false;  // a bound that bakes are held to
  nlohmann::json json_ = nlohmann::json::array();
};

}  // namespace

int bakeFolder(const BakeArguments& a, std::optional<Cache>& cache, const std::stop_token& stop) {
  const std::vector<fs::path> scenes = scenesIn(a.scene);
  if (scenes.empty())
    return reportError({a.scene.string(), "has no scenes in it", "name a folder of .gltf or .glb files"});
  FolderOutputs outputs(a.scene, a.output);
  FolderReport report(a);
  for (std::size_t i = 0; i < scenes.size() && !stop.stop_requested(); ++i) {
    const auto begun = std::chrono::steady_clock::now();
    const auto output = outputs.outputOf(scenes[i]);
    if (!output) {
      report.failed(scenes[i], output.error());
      continue;
    }
    BakeArguments one = a;
    one.scene = scenes[i];
    one.output = *output;
    one.say.label = fmt::format("{} of {}  {}  ", i + 1, scenes.size(), scenes[i].filename().string());
    if (const auto outcome = bakeScene(one, cache, stop))
      report.baked(one, *outcome, secondsSince(begun));
    else
      report.failed(scenes[i], outcome.error());
  }
  return report.end(scenes.size());
}

namespace {

int printOutcome(const BakeArguments& a, const Result<BakeOutcome>& outcome) {
  if (!outcome) return reportError(outcome.error());
  if (a.json) {
    fmt::print("{}\n", outcomeJson(a, *outcome).dump(2));
  } else if (!a.say.quiet) {
    if (*outcome)
      printReport({a.output, a.options, **outcome});
    else
      fmt::print("{} is up to date; --force bakes it again\n", a.output.string());
  }
  return failsStrictly(a, *outcome) ? 1 : 0;
}

// Bakes everything that was cut short, with the options that it had.
int resumeBakes(const BakeArguments& a, std::optional<Cache>& cache, const std::stop_token& stop) {
  if (!cache) return reportError({"--resume", "there is no cache that would tell", "leave out --cache off"});
  const std::vector<BakeRequest> unfinished = bakeJournal(cache).unfinished();
  if (unfinished.empty() && !a.say.quiet) fmt::print(stderr, "lambent: no bake was cut short\n");
  int worst = 0;
  for (const BakeRequest& request : unfinished) {
    if (stop.stop_requested()) break;
    if (std::error_code unknown; !std::filesystem::exists(request.scene, unknown)) {
      reportNotice(request.scene, "is gone; its bake is given up");
      bakeJournal(cache).forget(request);
      continue;
    }
    if (!a.say.quiet)
      fmt::print(stderr, "lambent: going on with {} to {}\n", request.scene.string(),
                 request.output.string());
    BakeArguments one = a;
    one.scene = request.scene;
    one.output = request.output;
    one.options = request.options;
    one.allow_outside = request.import.allow_outside;
    worst = std::max(worst, printOutcome(one, bakeScene(one, cache, stop)));
  }
  return worst;
}

int runBake(BakeArguments a) {
  if (!a.watch.empty()) {
    if (!a.scene.empty() || a.resume || a.force)
      return wrongUsage({"--watch", "is given with a scene, --resume or --force", "give it a folder alone"});
    std::optional<Cache> cache = bakeCache(a);
    return watchFolder(a, cache ? &*cache : nullptr);
  }
  if (a.scene.empty() && !a.resume)
    return wrongUsage({"SCENE", "is missing", "name a scene or a folder of scenes"});
  if (a.scene.empty() && !a.output.empty())
    return wrongUsage(
        {"--output", "is given with --resume alone", "leave it out: each bake knows its bundle"});
  std::error_code failed;
  const bool folder = std::filesystem::is_directory(a.scene, failed);
  if (!folder && a.output.empty()) a.output = bundleBeside(a.scene);
  const std::stop_source stop;
  const InterruptGuard interrupts(stop);
  std::optional<Cache> cache = bakeCache(a);
  if (a.scene.empty()) return resumeBakes(a, cache, stop.get_token());
  if (folder) return bakeFolder(a, cache, stop.get_token());
  return printOutcome(a, bakeScene(a, cache, stop.get_token()));
}

}  // namespace

void addBakeCommand(CLI::App& app, Command& run) {
  auto a = std::make_shared<BakeArguments>();
  CLI::App* command = app.add_subcommand("bake", "Bake a glTF scene, or a folder of them, into bundles");
  command->add_option("SCENE", a->scene, "The scene, .gltf or .glb, or a folder: all scenes in it and below");
  command_line::addValue(*command, "-o,--output", a->output, "PATH",
                         "The bundle to write, OUT.lmb.glb, or of a folder of scenes one for bundles; "
                         "default: beside the scene, with its name");
  command_line::addValue(*command, "--watch", a->watch, "DIR",
                         "Bake all scenes in DIR and below, then again what changes, until interrupted");
  command->add_flag("--resume", a->resume,
                    "Without SCENE: finish all bakes that were cut short. With it there is no need: a bake "
                    "always goes on from what the cache holds of it");
  addBakeOptions(*command, a->options);
  command->add_flag("--allow-outside", a->allow_outside,
                    "Read buffers and images outside the scene's folder too");
  command_line::addValue(*command, "--cache", a->cache, "DIR|off",
                         "Folder where results are kept, so that the next bake does only what changed; off: "
                         "none; default $LAMBENT_CACHE, else $XDG_CACHE_HOME/lambent, else "
                         "~/.cache/lambent");
  command_line::addBytes(
      *command, "--cache-size", a->cache_bytes,
      "Bytes that the cache may hold, like 8GB (default); what was not used longest goes first");
  command_line::addValue(*command, "--checkpoint", a->checkpoint_s, "S",
                         "How many seconds of work a bake that is killed may lose, about; default 8")
      ->check(CLI::Range(0.05, 600.0));
  command->add_flag(
      "--strict", a->strict,
      "Fail, with exit code 1, where the error of pictures misses its bound; the bundle is written");
  command->add_flag("--force", a->force,
                    "Bake all anew, even if the bundle is up to date and whatever the cache holds");
  command->add_flag("--json", a->json, "Print figures as JSON; of a folder an array of them");
  addQuiet(*command, a->say);
  addProgress(*command, a->say);
  command_line::group(*command, "Files and runs",
                      {"--output", "--watch", "--resume", "--force", "--allow-outside"});
  command_line::group(*command, "Accuracy", {"--strict"});
  command_line::group(*command, "Machine", {"--cache", "--cache-size", "--checkpoint"});
  command_line::group(*command, "Output", {"--json", "--quiet", "--progress"});
  command_line::addExamples(
      *command, {{"lambent bake scene.gltf", "bakes the scene to scene.lmb.glb beside it"},
                 {"lambent bake scene.gltf -o out.lmb.glb --quality draft", "takes the fewest rays"},
                 {"lambent bake scene.gltf --error 2%", "takes as many rays as 2 % of error need"},
                 {"lambent bake scenes -o bundles", "bakes all scenes of a folder, and fails if one fails"},
                 {"lambent bake --watch scenes -o bundles", "goes on with what changes there"}});
  command->callback([a, &run] { run = [a] { return runBake(*a); }; });
}

}  // namespace lambent::baker
