#include "baker/cli/bake_scene.hpp"

#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/cli/bake_report.hpp"
#include "baker/import/gltf.hpp"
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
  Result<BakeReport> report = [&] {
    const ProgressLine line(progress, WholeProgress(std::move(expected)), a.say, a.scene);
    return bake(*scene, a.options, a.output, {progress, stop, cache ? &*cache : nullptr});
  }();
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

}  // namespace lambent::baker
