#include "baker/cli/bake_scene.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/cli/bake_report.hpp"
#include "baker/cli/output.hpp"
#include "baker/import/gltf.hpp"
#include "baker/pipeline/bake_queue.hpp"
#include "baker/pipeline/guess_seconds.hpp"
#include "baker/pipeline/source_watch.hpp"
#include "baker/pipeline/whole_progress.hpp"
#include "runtime/base/atomic_file.hpp"

namespace lambent::baker {

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

Journal bakeJournal(const std::optional<Cache>& cache) {
  return Journal(cache ? cache->folder() / "journal" : std::filesystem::path());
}

Result<BakeOutcome> bakeScene(const BakeArguments& a, std::optional<Cache>& cache,
                              const std::stop_token& stop) {
  if (const auto readable = checkRegularFile(a.scene, "a scene, .gltf or .glb"); !readable)
    return failAgain(readable.error());
  if (const auto checked = checkRequest(a.options, a.output); !checked) return failAgain(checked.error());
  Journal::Entry record = bakeJournal(cache).begin({.scene = a.scene,
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
    return failAgain(scene.error());
  }
  for (const std::string& warning : scene->warnings) reportNotice(a.scene, warning);
  if (!a.force && isUpToDate(*scene, a.options, a.output)) {
    record.done();
    return BakeOutcome{};
  }
  PartSeconds expected;
  if (const auto plan = planFor(*scene, a.options)) {
    BakeGuess guess = guessBake(*scene, *plan, a.options);
    if (const auto notice = longBakeNotice(guess.processor_seconds); notice && !a.say.quiet)
      reportNotice(a.scene, *notice);
    expected = std::move(guess.seconds);
  }
  if (cache) cache->setReading(!a.force);
  const Key progress_key = progressKey(*scene, a.options);
  Result<BakeReport> report = [&] {
    const WholeProgress whole(std::move(expected), cache ? findProgress(progress_key, *cache) : 0.0);
    std::optional<ProgressWatch> keeper;
    if (cache) keeper.emplace(keepProgress(progress, whole, *cache, progress_key));
    const ProgressLine line(progress, whole, a.say, a.scene);
    return bake(*scene, a.options, a.output, {progress, stop, cache ? &*cache : nullptr});
  }();
  if (report && cache) cache->drop(progress_key);
  if (!stop.stop_requested()) record.done();  // otherwise --resume continues it
  if (!report) {
    if (stop.stop_requested())
      report.error().hint = cache ? "bake it again, or give --resume, and it goes on from where it was"
                                  : "with a cache, the next bake would go on from where it was";
    return failAgain(report.error());
  }
  for (const std::string& notice : report->notices) reportNotice(a.scene, notice);
  return std::move(*report);
}

bool failsStrictly(const BakeArguments& a, const BakeOutcome& outcome) {
  return a.strict && outcome && missesBound({a.output, a.options, *outcome});
}

nlohmann::json outcomeJson(const BakeArguments& a, const BakeOutcome& outcome) {
  if (!outcome) return {{"output", a.output.string()}, {"upToDate", true}};
  return reportJson({a.output, a.options, *outcome});
}

namespace fs = std::filesystem;

Result<fs::path> FolderOutputs::outputOf(const fs::path& scene) {
  fs::path output = bundleBeside(scene);
  if (!output_.empty())
    output =
        (output_ / scene.parent_path().lexically_relative(folder_)).lexically_normal() / output.filename();
  const auto [entry, added] = scene_of_.try_emplace(output, scene);
  if (!added && entry->second != scene)
    return fail(scene.string(),
                fmt::format("would be baked to {}, where {} is", output.string(), entry->second.string()),
                "rename one of them");
  std::error_code ignored;  // the bake reports that it cannot write
  fs::create_directories(output.parent_path(), ignored);
  return output;
}

void FolderOutputs::forget(const fs::path& scene) {
  std::erase_if(scene_of_, [&](const auto& entry) { return entry.second == scene; });
}

namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kTurn{100};

class FolderBakes {
 public:
  FolderBakes(const BakeArguments& arguments, BakeQueue& queue) : arguments_(arguments), queue_(queue) {}

  // Prints one line for each event.
  void say(const char* event, const fs::path& scene, const std::string& text,
           nlohmann::json more = nlohmann::json::object()) const {
    if (arguments_.json) {
      more["event"] = event;
      if (!scene.empty()) more["scene"] = scene.string();
      fmt::print("{}\n", more.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    } else if (arguments_.say.quiet) {
      if (more.contains("error")) reportNotice(scene, text);
    } else {
      fmt::print("{}\n", scene.empty() ? text : scene.string() + ": " + text);
    }
    std::fflush(stdout);
  }

  void take(const WatchEvent& event) {
    switch (event.kind) {
      case WatchEvent::Kind::Found:
      case WatchEvent::Kind::Changed:
        return add(event.scene);
      case WatchEvent::Kind::Broken:
        failed_.insert(event.scene);
        return say("broken", event.scene, event.error->line() + "; waiting for it to change",
                   {{"error", event.error->line()}});
      case WatchEvent::Kind::Removed:
        if (const auto job = jobs_.find(event.scene); job != jobs_.end()) queue_.cancel(job->second);
        outputs_.forget(event.scene);
        failed_.erase(event.scene);
        return say("removed", event.scene, "is gone; its bundle stays");
    }
  }

  void take(const BakeEvent& event) {
    const std::vector<JobState> states = queue_.states();
    const auto state =
        std::find_if(states.begin(), states.end(), [&](const JobState& s) { return s.id == event.job; });
    if (state == states.end()) return;
    const fs::path& scene = state->request.scene;
    const std::string output = state->request.output.string();
    switch (event.kind) {
      case BakeEvent::Kind::Began:
        return say("baking", scene, "baking", {{"output", output}});
      case BakeEvent::Kind::Failed:
        failed_.insert(scene);
        if (state->error)
          say("failed", scene, state->error->line(), {{"output", output}, {"error", state->error->line()}});
        return;
      case BakeEvent::Kind::Cancelled:
        return;  // the scene is gone, which was reported
      case BakeEvent::Kind::Bundle:
        break;
    }
    failed_.erase(scene);
    for (const std::string& warning : state->warnings) reportNotice(scene, warning);
    if (state->up_to_date) return say("upToDate", scene, output + " is up to date", {{"output", output}});
    if (!state->report) return;
    const BakeReport& report = *state->report;
    say("baked", scene,
        fmt::format("{} in {}, {}", output, durationText(state->seconds),
                    bytesText(static_cast<double>(report.file_bytes))),
        {{"output", output},
         {"seconds", state->seconds},
         {"fileBytes", report.file_bytes},
         {"vertices", report.vertices},
         {"rays", report.rays},
         {"raysKept", report.rays_kept}});
  }

  // Returns whether a scene has no bundle that shows it as it is.
  bool anyFailed() const { return !failed_.empty(); }

 private:
  void add(const fs::path& scene) {
    const Result<fs::path> output = outputs_.outputOf(scene);
    if (!output) {
      failed_.insert(scene);
      return say("failed", scene, output.error().line(), {{"error", output.error().line()}});
    }
    jobs_.insert_or_assign(scene, queue_.add({.scene = scene,
                                              .output = *output,
                                              .options = arguments_.options,
                                              .import = {.allow_outside = arguments_.allow_outside}}));
  }

  const BakeArguments& arguments_;
  BakeQueue& queue_;
  std::map<fs::path, JobId> jobs_;
  FolderOutputs outputs_{arguments_.watch, arguments_.output};
  std::set<fs::path> failed_;  // scenes that are broken or whose last bake failed
};

}  // namespace

int watchFolder(const BakeArguments& arguments, Cache* cache) {
  std::error_code failed;
  if (!fs::is_directory(arguments.watch, failed))
    return reportError(
        {arguments.watch.string(), "is no folder", "give --watch a folder of .gltf or .glb files"});
  const std::stop_source stop;
  const InterruptGuard interrupts(stop);
  SourceWatch watch({arguments.watch}, {.import = {.allow_outside = arguments.allow_outside}});
  BakeQueue queue({.work_folder = cache ? cache->folder() : fs::path(), .cache = cache, .previews = false});
  FolderBakes bakes(arguments, queue);
  bakes.say("watching", {}, "watching " + arguments.watch.string() + "; interrupt to end",
            {{"folder", arguments.watch.string()}});
  while (!stop.stop_requested()) {
    for (const WatchEvent& event : watch.takeEvents()) bakes.take(event);
    queue.waitForEvents(kTurn);
    for (const BakeEvent& event : queue.takeEvents()) bakes.take(event);
  }
  const bool cut_short = queue.busy();
  bakes.say("ended", {},
            cut_short ? "ended; what was cut short goes on with the next bake, or --resume" : "ended",
            {{"cutShort", cut_short}});
  return bakes.anyFailed() ? 1 : 0;
}

}  // namespace lambent::baker
