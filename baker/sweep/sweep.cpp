#include "baker/sweep/sweep.hpp"

#include <array>
#include <fstream>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "baker/bake/bake.hpp"
#include "baker/import/gltf.hpp"
#include "baker/import/scene_digest.hpp"
#include "runtime/base/atomic_file.hpp"
#include "runtime/base/process.hpp"

namespace lambent::baker {

namespace {

Result<Programs> findPrograms() {
  const Result<std::filesystem::path> self = ownProgram();
  if (!self) return failAgain(self.error());
  Programs programs{.lambent = *self, .demo = self->parent_path() / "lambent-demo"};
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(programs.demo, ignored))
    return fail(programs.demo.string(), "is missing, which draws the pictures that are measured",
                "build lambent-demo, or unpack the archive lambent-demo over this one");
  return programs;
}

Result<std::filesystem::path> findSampleScene() {
  constexpr const char* kSampleScene = "knot.glb";
  std::error_code ignored;
  for (const std::filesystem::path& folder : sampleFolders())
    if (auto scene = folder / kSampleScene; std::filesystem::is_regular_file(scene, ignored)) return scene;
  return fail(kSampleScene, "is not beside this program, and no other SCENE is named",
              "build the target assets, or name a scene");
}

// Returns the processor's name and its number of threads, because times of another one cannot be compared.
std::string machineName() {
  std::string name = "unknown processor";
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const std::size_t colon = line.find(": ");
    if (!line.starts_with("model name") || colon == std::string::npos) continue;
    name = line.substr(colon + 2);
    break;
  }
  return fmt::format("{}, {} threads", name, std::thread::hardware_concurrency());
}

struct Effort {
  const char* size;
  std::uint32_t spp;
  int frames;
};
constexpr std::array kEfforts = {Effort{"320x180", 64, 6}, Effort{"480x270", 256, 9},
                                 Effort{"960x540", 1024, 17}};  // by quality

}  // namespace

Result<SweepResults> runSweep(SweepRequest request, const SweepListener& listener,
                              const std::stop_token& stop) {
  const auto programs = findPrograms();
  if (!programs) return failAgain(programs.error());
  if (request.scene.empty()) {
    auto sample = findSampleScene();
    if (!sample) return failAgain(sample.error());
    request.scene = std::move(*sample);
  }
  if (const auto readable = checkRegularFile(request.scene, "a scene, .gltf or .glb"); !readable)
    return failAgain(readable.error());
  const auto scene = importScene(request.scene, {.allow_outside = request.allow_outside});
  if (!scene) return failAgain(scene.error());
  const auto plan = planFor(*scene, BakeOptions{.quality = request.quality});
  if (!plan) return failAgain(plan.error());
  const SceneFacts facts = factsOf(*plan);
  const auto settings = settingsOf(facts, request.quality, request.knobs);
  if (!settings) return failAgain(settings.error());
  const std::filesystem::path work = request.output / "work";
  std::error_code failed, ignored;
  std::filesystem::create_directories(work, failed);
  if (failed) return fail(work.string(), "cannot be made: " + failed.message(), "name another folder");
  const std::filesystem::path file = request.output / "results.jsonl";
  if (request.force) std::filesystem::remove(file, ignored);
  auto store = Store::open(file);
  if (!store) return failAgain(store.error());

  const Effort effort = kEfforts.at(static_cast<std::size_t>(request.quality));
  SweepResults results{.scene = request.scene.stem().string(),
                       .quality = request.quality,
                       .view = {.lights = request.lights,
                                .camera = request.camera,
                                .size = request.size.empty() ? effort.size : request.size,
                                .spp = request.spp > 0 ? request.spp : effort.spp,
                                .frames = effort.frames},
                       .machine = machineName(),
                       .asked = settings->size()};
  std::size_t done = 0;
  Measurer measurer({.programs = *programs,
                     .scene = request.scene,
                     .work = work,
                     .scene_digest = sceneDigest(*scene),
                     .glossy = facts.glossy,
                     .allow_outside = request.allow_outside,
                     .view = results.view,
                     .begin =
                         [&](const std::string& what) {
                           if (listener.begin) listener.begin(done, results.asked, what);
                         }},
                    *store, stop);
  for (const Setting& setting : *settings) {
    if (stop.stop_requested()) break;
    // The base comes to the same with any number of key lights if there are none to find.
    if (!results.settings.empty() && setting.isOfKeyLights() &&
        results.settings.front().picture.at("keyLights") == 0) {
      --results.asked;
      continue;
    }
    auto measured = measurer.measure(setting);
    if (stop.stop_requested()) break;
    if (!measured) {
      if (results.settings.empty()) return failAgain(measured.error());
      results.failures.push_back(fmt::format("{}: {}", setting.name(), measured.error().line()));
    } else {
      results.settings.push_back(std::move(*measured));
      if (listener.measured) listener.measured(done + 1, results.asked, results.settings.back());
    }
    ++done;
  }
  results.stopped = stop.stop_requested();
  results.rows_measured = store->added();
  if (results.settings.empty())
    return fail("lambent", "stopped", "run it again, and it goes on from where it was");
  if (const auto reference = measurer.reference(""); reference) {
    results.reference_seconds = (*reference)->seconds;
    results.reference_shown = (*reference)->shown;
  }
  return results;
}

}  // namespace lambent::baker
