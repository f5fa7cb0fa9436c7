#include <chrono>
#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/cli/bake_scene.hpp"
#include "baker/cli/folder_outputs.hpp"
#include "baker/pipeline/source_watch.hpp"
#include "baker/plan/counted.hpp"

namespace lambent::baker {

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

}  // namespace lambent::baker
