// Implements lambent bake SCENE [-o OUT.lmb.glb], --watch DIR, --resume.
#include <memory>
#include <optional>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/bake/bake.hpp"
#include "baker/cli/bake_report.hpp"
#include "baker/cli/commands.hpp"
#include "baker/cli/output.hpp"
#include "baker/cli/watch.hpp"
#include "baker/import/gltf.hpp"
#include "baker/pipeline/bake_estimate.hpp"
#include "baker/pipeline/journal.hpp"
#include "baker/pipeline/progress_record.hpp"
#include "baker/pipeline/source_watch.hpp"
#include "baker/pipeline/time_budget.hpp"
#include "runtime/base/atomic_file.hpp"

namespace lambent::baker {

namespace {

struct BakeArguments {
  std::filesystem::path scene, output;
  std::filesystem::path watch;  // a folder; empty means none
  bool resume = false;
  double checkpoint_s = 0.0;  // 0 keeps the cache's own interval
  double time_s = 0.0;        // 0: the options say all
  BakeOptions options;
  bool force = false, json = false, allow_outside = false;
  std::string cache;  // a folder, "off", or empty for the default one
  std::uint64_t cache_bytes = kCacheBytes;
};

std::optional<Cache> cacheOf(const BakeArguments& a) {
  auto cache = openCache(a.cache, a.cache_bytes);
  if (cache && a.checkpoint_s > 0.0) cache->setCheckpointEvery(a.checkpoint_s);
  return cache;
}

// The journal of this program lies in the cache's folder.
Journal journalOf(const std::optional<Cache>& cache) {
  return Journal(cache ? cache->folder() / "journal" : std::filesystem::path());
}

int bakeScene(const BakeArguments& a, std::optional<Cache>& cache, const std::stop_token& stop) {
  if (const auto readable = checkRegularFile(a.scene, "a scene, .gltf or .glb"); !readable)
    return reportError(readable.error());
  if (const auto checked = checkRequest(a.options, a.output); !checked) return reportError(checked.error());
  Journal::Entry record = journalOf(cache).begin({.scene = a.scene,
                                                  .output = a.output,
                                                  .options = a.options,
                                                  .import = {.allow_outside = a.allow_outside}});
  if (record.error())
    fmt::print(stderr, "lambent: {}; --resume will not know of this bake\n", record.error()->line());
  Progress progress;
  progress.begin("import");
  auto scene = importScene(a.scene, {.allow_outside = a.allow_outside});
  if (!scene) {
    record.done();
    return reportError(scene.error());
  }
  for (const std::string& warning : scene->warnings) reportNotice(a.scene, warning);
  if (!a.force && isUpToDate(*scene, a.options, a.output)) {
    record.done();
    if (a.json)
      fmt::print("{}\n", nlohmann::json{{"output", a.output.string()}, {"upToDate", true}}.dump(2));
    else
      fmt::print("{} is up to date; --force bakes it again\n", a.output.string());
    return 0;
  }
  const auto estimate = cache ? findEstimate(*scene, a.options, *cache) : std::nullopt;
  if (cache) cache->setReading(!a.force);
  const Key progress_key = progressKey(*scene, a.options);
  Result<BakeReport> report = [&] {
    const StageSeconds expected = estimate ? estimate->stages : guessSeconds(*scene, a.options);
    const ProgressRecord begun = cache ? findProgress(progress_key, *cache) : ProgressRecord{};
    std::optional<ProgressKeeper> keeper;
    if (cache) keeper.emplace(progress, expected, begun, *cache, progress_key);
    const ProgressLine line(progress, WholeProgress(expected, begun));
    return bake(*scene, a.options, a.output, {progress, stop, cache ? &*cache : nullptr});
  }();
  if (report && cache) cache->drop(progress_key);
  if (!stop.stop_requested()) record.done();  // otherwise --resume continues it
  if (!report) {
    if (stop.stop_requested())
      report.error().hint = cache ? "bake it again, or give --resume, and it goes on from where it was"
                                  : "with a cache, the next bake would go on from where it was";
    return reportError(report.error());
  }
  for (const std::string& notice : report->notices) reportNotice(a.scene, notice);
  if (a.json)
    printReportJson({a.output, a.options, *report, estimate});
  else
    printReport({a.output, a.options, *report, estimate});
  return 0;
}

// Replaces the options by those with which the bake takes about the time that was asked for.
Result<void> chooseByTime(BakeArguments& a, const std::stop_token& stop) {
  const auto scene = importScene(a.scene, {.allow_outside = a.allow_outside});
  if (!scene) return failAgain(scene.error());
  Progress unused;
  const auto chosen = optionsForTime(*scene, a.options, a.time_s, {unused, stop});
  if (!chosen) return failAgain(chosen.error());
  a.options = chosen->options;
  reportNotice(a.scene, fmt::format("baked with {}, which takes about {}{}", chosen->words,
                                    durationText(chosen->seconds),
                                    chosen->seconds > a.time_s ? "; nothing coarser takes less" : ""));
  return {};
}

// Reports an error in the command line and returns the exit code 2.
int wrongUsage(const Error& error) {
  reportError(error);
  return 2;
}

// Bakes everything that was cut short, with the options that it had.
int resumeBakes(const BakeArguments& a, std::optional<Cache>& cache, const std::stop_token& stop) {
  if (!cache) return reportError({"--resume", "there is no cache that would tell", "leave out --cache off"});
  const std::vector<BakeRequest> unfinished = journalOf(cache).unfinished();
  if (unfinished.empty()) fmt::print(stderr, "lambent: no bake was cut short\n");
  int worst = 0;
  for (const BakeRequest& request : unfinished) {
    if (stop.stop_requested()) break;
    if (std::error_code unknown; !std::filesystem::exists(request.scene, unknown)) {
      reportNotice(request.scene, "is gone; its bake is given up");
      journalOf(cache).forget(request);
      continue;
    }
    fmt::print(stderr, "lambent: going on with {} to {}\n", request.scene.string(), request.output.string());
    BakeArguments one = a;
    one.scene = request.scene;
    one.output = request.output;
    one.options = request.options;
    one.allow_outside = request.import.allow_outside;
    worst = std::max(worst, bakeScene(one, cache, stop));
  }
  return worst;
}

int runBake(BakeArguments a) {
  if (!a.watch.empty()) {
    if (!a.scene.empty() || a.resume || a.force || a.time_s > 0.0)
      return wrongUsage(
          {"--watch", "is given with a scene, --resume, --force or --time", "give it a folder alone"});
    std::optional<Cache> cache = cacheOf(a);
    return watchFolder({a.watch, a.output, a.options, {.allow_outside = a.allow_outside}, a.json},
                       cache ? &*cache : nullptr);
  }
  if (a.scene.empty() && !a.resume)
    return wrongUsage({"SCENE", "is missing", "name a scene, or a folder with --watch"});
  if (a.scene.empty() && !a.output.empty())
    return wrongUsage(
        {"--output", "is given with --resume alone", "leave it out: each bake knows its bundle"});
  if (a.time_s > 0.0 && (a.scene.empty() || a.options.picture_bound > 0.0f))
    return wrongUsage({"--time", "is given with --resume or --error", "give it with a scene, and one bound"});
  if (a.output.empty()) a.output = bundleBeside(a.scene);
  const std::stop_source stop;
  const InterruptGuard interrupts(stop);
  if (a.time_s > 0.0) {
    if (const auto checked = checkRequest(a.options, a.output); !checked) return reportError(checked.error());
    if (const auto done = chooseByTime(a, stop.get_token()); !done) return reportError(done.error());
  }
  std::optional<Cache> cache = cacheOf(a);
  return a.scene.empty() ? resumeBakes(a, cache, stop.get_token()) : bakeScene(a, cache, stop.get_token());
}

}  // namespace

void addBakeCommand(CLI::App& app, Command& run) {
  auto a = std::make_shared<BakeArguments>();
  CLI::App* command = app.add_subcommand("bake", "Bake a glTF scene into a bundle");
  command->add_option("SCENE", a->scene, "The scene, .gltf or .glb");
  command->add_option("-o,--output", a->output,
                      "The bundle to write, OUT.lmb.glb, or with --watch a folder for bundles; default: "
                      "beside the scene, with its name");
  command
      ->add_option("--watch", a->watch,
                   "Bake all scenes in DIR and below, then again what changes, until interrupted")
      ->type_name("DIR");
  command->add_flag("--resume", a->resume,
                    "Without SCENE: finish all bakes that were cut short. With it there is no need: a bake "
                    "always goes on from what the cache holds of it");
  addBakeOptions(*command, a->options);
  command->add_flag("--allow-outside", a->allow_outside,
                    "Read buffers and images outside the scene's folder too");
  command
      ->add_option(
          "--cache", a->cache,
          "Folder where results are kept, so that the next bake does only what changed; off: none; default "
          "$LAMBENT_CACHE, else $XDG_CACHE_HOME/lambent, else ~/.cache/lambent")
      ->type_name("DIR|off");
  command
      ->add_option("--cache-size", a->cache_bytes,
                   "Bytes that the cache may hold, like 8GB (default); what was not used longest goes first")
      ->transform(CLI::AsSizeValue(/*kb_is_1000=*/false))
      ->type_name("BYTES");
  command
      ->add_option("--checkpoint", a->checkpoint_s,
                   "How many seconds of work a bake that is killed may lose, about; default 8")
      ->check(CLI::Range(0.05, 600.0))
      ->type_name("S");
  command
      ->add_option(
          "--time", a->time_s,
          "Choose --quality, and --rays, --refine and --codes as far as they are not given, so that the "
          "bake takes about so many seconds here, its rehearsals included, on a machine that does "
          "nothing else: measured 0.6 to 1.1 times as many. Says which were chosen")
      ->check(CLI::Range(0.1, 1e6))
      ->type_name("S");
  command->add_flag("--force", a->force,
                    "Bake all anew, even if the bundle is up to date and whatever the cache holds");
  command->add_flag("--json", a->json, "Print figures as JSON");
  command->callback([a, &run] { run = [a] { return runBake(*a); }; });
}

}  // namespace lambent::baker
