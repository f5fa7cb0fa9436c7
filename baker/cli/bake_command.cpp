// Implements lambent bake SCENE [-o OUT.lmb.glb]. SCENE may be a folder.
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <system_error>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/bake/bake.hpp"
#include "baker/bake/options.hpp"
#include "baker/cache/cache.hpp"
#include "baker/cli/commands.hpp"
#include "baker/import/gltf.hpp"
#include "baker/pipeline/source_watch.hpp"
#include "baker/pipeline/whole_progress.hpp"
#include "baker/plan/counted.hpp"
#include "runtime/base/atomic_file.hpp"
#include "runtime/base/result.hpp"
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

struct BakeArguments {
  std::filesystem::path scene, output;
  double checkpoint_s = 0.0;  // 0 keeps the cache's own interval
  BakeOptions options;
  bool force = false, json = false, allow_outside = false;
  bool strict = false;  // a bake that misses a bound fails
  std::string cache;    // a folder, "off", or empty for the default one
  std::uint64_t cache_bytes = kCacheBytes;
  SayOptions say;
};

using BakeOutcome = std::optional<BakeReport>;

// Opens the cache that the arguments name, if any. A bake without a cache is only slower, so a problem with
// the folder is reported and no error.
std::optional<Cache> bakeCache(const BakeArguments& a) {
  if (a.cache == "off") return std::nullopt;
  const std::filesystem::path folder =
      a.cache.empty() ? Cache::defaultFolder() : std::filesystem::path(a.cache);
  if (folder.empty()) return std::nullopt;
  auto cache = Cache::open(folder, a.cache_bytes);
  if (!cache) {
    fmt::print(stderr, "lambent: {}; going on without it\n", cache.error().line());
    return std::nullopt;
  }
  if (a.checkpoint_s > 0.0) cache->setCheckpointEvery(a.checkpoint_s);
  return std::move(*cache);
}

// Returns the report, or nothing if the bundle was up to date. Progress is shown, and a bundle that is up
// to date is left alone.
Result<BakeOutcome> bakeScene(const BakeArguments& a, std::optional<Cache>& cache,
                              const std::stop_token& stop) {
  if (const auto readable = checkRegularFile(a.scene, "a scene, .gltf or .glb"); !readable)
    return failAgain(readable.error());
  if (const auto checked = checkRequest(a.options, a.output); !checked) return failAgain(checked.error());
  Progress progress;
  progress.begin("import");
  auto scene = importScene(a.scene, {.allow_outside = a.allow_outside});
  if (!scene) return failAgain(scene.error());
  for (const std::string& warning : scene->warnings) reportNotice(a.scene, warning);
  if (!a.force && isUpToDate(*scene, a.options, a.output)) return BakeOutcome{};
  PartSeconds expected;
  if (const auto plan = planFor(*scene, a.options)) {
    BakeGuess guess = guessBake(*scene, *plan, a.options);
    if (const auto notice = longBakeNotice(guess.processor_seconds); notice && !a.say.quiet)
      reportNotice(a.scene, *notice);
    expected = std::move(guess.seconds);
  }
  if (cache) cache->setReading(!a.force);
  Result<BakeReport> report = [&] {
    const ProgressLine line(progress, WholeProgress(std::move(expected)), a.say, a.scene);
    return bake(*scene, a.options, a.output, {progress, stop, cache ? &*cache : nullptr});
  }();
  if (!report) {
    if (stop.stop_requested())
      report.error().hint = cache ? "bake it again, and it goes on from where it was"
                                  : "with a cache, the next bake would go on from where it was";
    return failAgain(report.error());
  }
  for (const std::string& notice : report->notices) reportNotice(a.scene, notice);
  return std::move(*report);
}

// Returns whether the bake missed a bound and is to fail for it.
bool failsStrictly(const BakeArguments& a, const BakeOutcome& outcome) {
  return a.strict && outcome && missesBound({a.output, a.options, *outcome});
}

nlohmann::json outcomeJson(const BakeArguments& a, const BakeOutcome& outcome) {
  if (!outcome) return {{"output", a.output.string()}, {"upToDate", true}};
  return reportJson({a.output, a.options, *outcome});
}

// Returns where a scene of a folder is baked to: beside the scene, or under a folder for bundles that mirrors
// the scenes' own, which it makes.
fs::path outputOf(const BakeArguments& a, const fs::path& scene) {
  fs::path output = bundleBeside(scene);
  if (!a.output.empty())
    output =
        (a.output / scene.parent_path().lexically_relative(a.scene)).lexically_normal() / output.filename();
  std::error_code ignored;  // the bake reports that it cannot write
  fs::create_directories(output.parent_path(), ignored);
  return output;
}

double secondsSince(std::chrono::steady_clock::time_point begun) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

// Bakes every scene of the folder `a.scene` once, and counts and prints what came of each. `a.output` is a
// folder for bundles, or empty: beside the scenes. Returns the exit code: 1 if a scene has no bundle that
// shows it as it is.
int bakeFolder(const BakeArguments& a, std::optional<Cache>& cache, const std::stop_token& stop) {
  const auto begun = std::chrono::steady_clock::now();
  const std::vector<fs::path> scenes = scenesIn(a.scene);
  if (scenes.empty())
    return reportError({a.scene.string(), "has no scenes in it", "name a folder of .gltf or .glb files"});
  const auto say = [&](const std::string& line) {
    if (a.json || a.say.quiet) return;
    fmt::print("{}\n", line);
    std::fflush(stdout);
  };
  std::map<fs::path, fs::path> scene_of;  // by output
  std::size_t baked = 0, up_to_date = 0, failed = 0;
  bool missed = false;  // a bound that bakes are held to
  nlohmann::json json = nlohmann::json::array();
  for (std::size_t i = 0; i < scenes.size() && !stop.stop_requested(); ++i) {
    const auto scene_begun = std::chrono::steady_clock::now();
    const std::string scene = scenes[i].string();
    BakeArguments one = a;
    one.scene = scenes[i];
    one.output = outputOf(a, scenes[i]);
    one.say.label = fmt::format("{} of {}  {}  ", i + 1, scenes.size(), scenes[i].filename().string());
    const auto [entry, added] = scene_of.try_emplace(one.output, one.scene);
    const Result<BakeOutcome> outcome = added ? bakeScene(one, cache, stop)
                                              : fail(scene,  // such as a.gltf beside a.glb
                                                     fmt::format("would be baked to {}, where {} is",
                                                                 one.output.string(), entry->second.string()),
                                                     "rename one of them");
    if (!outcome) {
      ++failed;
      // Errors of options and outputs do not name the scene.
      const Error& error = outcome.error();
      reportError(error.subject == scene ? error : Error{scene, error.line(), {}});
      json.push_back({{"scene", scene}, {"error", error.line()}});
      continue;
    }
    ++(*outcome ? baked : up_to_date);
    missed |= failsStrictly(one, *outcome);
    json.push_back(outcomeJson(one, *outcome));
    json.back()["scene"] = scene;
    if (*outcome)
      say(fmt::format("{}: {} in {}, {}", scene, one.output.string(), durationText(secondsSince(scene_begun)),
                      bytesText(static_cast<double>((*outcome)->file_bytes))));
    else
      say(fmt::format("{}: {} is up to date", scene, one.output.string()));
  }
  const std::size_t missing = scenes.size() - baked - up_to_date - failed;
  if (a.json) fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  say(fmt::format("{}: {} baked, {} up to date, {} failed{} in {}", counted(scenes.size(), "scene"), baked,
                  up_to_date, failed, missing > 0 ? fmt::format(", {} not begun", missing) : "",
                  durationText(secondsSince(begun))));
  return failed + missing > 0 || missed ? 1 : 0;
}

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

int runBake(BakeArguments a) {
  std::error_code failed;
  const bool folder = std::filesystem::is_directory(a.scene, failed);
  if (!folder && a.output.empty()) a.output = bundleBeside(a.scene);
  const std::stop_source stop;
  const InterruptGuard interrupts(stop);
  std::optional<Cache> cache = bakeCache(a);
  if (folder) return bakeFolder(a, cache, stop.get_token());
  return printOutcome(a, bakeScene(a, cache, stop.get_token()));
}

}  // namespace

void addBakeCommand(CLI::App& app, Command& run) {
  auto a = std::make_shared<BakeArguments>();
  CLI::App* command = app.add_subcommand("bake", "Bake a glTF scene, or a folder of them, into bundles");
  command->add_option("SCENE", a->scene, "The scene, .gltf or .glb, or a folder: all scenes in it and below")
      ->required();
  command_line::addValue(*command, "-o,--output", a->output, "PATH",
                         "The bundle to write, OUT.lmb.glb, or of a folder of scenes one for bundles; "
                         "default: beside the scene, with its name");
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
  command_line::group(*command, "Files and runs", {"--output", "--force", "--allow-outside"});
  command_line::group(*command, "Accuracy", {"--strict"});
  command_line::group(*command, "Machine", {"--cache", "--cache-size", "--checkpoint"});
  command_line::group(*command, "Output", {"--json", "--quiet", "--progress"});
  command_line::addExamples(
      *command, {{"lambent bake scene.gltf", "bakes the scene to scene.lmb.glb beside it"},
                 {"lambent bake scene.gltf -o out.lmb.glb --quality draft", "takes the fewest rays"},
                 {"lambent bake scene.gltf --error 2%", "takes as many rays as 2 % of error need"},
                 {"lambent bake scenes -o bundles", "bakes all scenes of a folder, and fails if one fails"}});
  command->callback([a, &run] { run = [a] { return runBake(*a); }; });
}

}  // namespace lambent::baker
