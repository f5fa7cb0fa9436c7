#include "baker/sweep/sweep.hpp"

#include <algorithm>
#include <cmath>
#include <system_error>

#include <fmt/format.h>

#include "baker/bake/bake.hpp"
#include "baker/import/gltf.hpp"
#include "baker/sweep/machine.hpp"

namespace lambent::baker {

namespace {

struct Effort {
  const char* size;
  std::uint32_t spp;
  int frames;
};

Effort effortOf(Quality quality) {
  switch (quality) {
    case Quality::Draft:
      return {"320x180", 64, 6};
    case Quality::Standard:
      return {"480x270", 256, 9};
    case Quality::High:
      break;
  }
  return {"960x540", 1024, 17};
}

Result<void> makeFolder(const std::filesystem::path& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) return fail(folder.string(), "cannot be made: " + failed.message(), "name another folder");
  return {};
}

// The base comes to the same with any number of key lights if there are none to find.
bool hasNothingToTurn(const Setting& setting, const Measured& base) {
  return setting.isOfKeyLights() && base.picture.key_lights == 0;
}

Result<Measured> measure(Measurer& measurer, const Setting& setting) {
  auto bake = measurer.bake(setting);
  if (!bake) return failAgain(bake.error());
  auto picture = measurer.picture(setting);
  if (!picture) return failAgain(picture.error());
  const auto visible = measurer.visible(setting);
  if (!visible) return failAgain(visible.error());
  return Measured{setting,  measurer.keyOf(setting),      std::move(*bake), std::move(*picture),
                  *visible, measurer.pictureFile(setting)};
}

}  // namespace

ErrorParts partsOf(const Measured& measured) {
  const double all = measured.picture.as_light_is.rms;
  ErrorParts parts{.within_bands = std::min(measured.picture.as_bands_can.rms, all)};
  parts.beyond_bands = std::sqrt(std::max(0.0, all * all - parts.within_bands * parts.within_bands));
  if (!measured.bake.parts) return parts;
  const BakeRow::Parts& said = *measured.bake.parts;
  const double sum = std::hypot(said.noise, said.codes, said.interpolation);
  if (!(sum > 0.0)) return parts;
  parts.noise = parts.within_bands * said.noise / sum;
  parts.codes = parts.within_bands * said.codes / sum;
  parts.interpolation = parts.within_bands * said.interpolation / sum;
  return parts;
}

Result<SweepResults> runSweep(const SweepRequest& request, const SweepListener& listener,
                              const std::stop_token& stop) {
  const auto scene = importScene(request.scene, {.allow_outside = request.allow_outside});
  if (!scene) return failAgain(scene.error());
  const auto plan = planFor(*scene, BakeOptions{.quality = request.quality});
  if (!plan) return failAgain(plan.error());
  const SceneFacts facts = factsOf(*plan);
  const auto settings = settingsOf(facts, request.quality, request.knobs);
  if (!settings) return failAgain(settings.error());
  const std::filesystem::path work = request.output / "work";
  if (auto made = makeFolder(work); !made) return failAgain(made.error());
  const std::filesystem::path file = request.output / "results.jsonl";
  std::error_code ignored;
  if (request.force) std::filesystem::remove(file, ignored);
  auto store = Store::open(file);
  if (!store) return failAgain(store.error());

  const Effort effort = effortOf(request.quality);
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
  Measurer measurer({.programs = request.programs,
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
    if (!results.settings.empty() && hasNothingToTurn(setting, results.settings.front())) {
      --results.asked;
      continue;
    }
    auto measured = measure(measurer, setting);
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
  results.exposure = measurer.exposure();
  if (results.settings.empty())
    return fail("lambent", "stopped", "run it again, and it goes on from where it was");
  if (const auto reference = measurer.reference(""); reference) {
    results.reference = (*reference)->mean;
    results.reference_row = (*reference)->row;
  }
  return results;
}

}  // namespace lambent::baker
