#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <set>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/cli/bake_scene.hpp"
#include "baker/cli/output.hpp"
#include "baker/pipeline/bake_queue.hpp"
#include "baker/pipeline/source_watch.hpp"

namespace lambent::baker {

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
