#include "editor/session/plans.hpp"

#include <algorithm>

#include "baker/bake/bake.hpp"
#include "baker/import/gltf.hpp"

namespace lambent::editor {

namespace {

Result<ScenePlan> make(const std::filesystem::path& scene, const baker::BakeOptions& options) {
  try {
    auto imported = baker::importScene(scene, {});
    if (!imported) return failAgain(imported.error());
    auto plan = baker::planFor(*imported, options);
    if (!plan) return failAgain(plan.error());
    return ScenePlan{std::move(*plan), std::move(imported->warnings)};
  } catch (const std::exception& error) {
    return fail(scene.string(), error.what());
  }
}

}  // namespace

const Result<ScenePlan>* Plans::find(const std::filesystem::path& scene, const baker::BakeOptions& options) {
  std::error_code ignored;
  const auto time = std::filesystem::last_write_time(scene, ignored);
  Entry& entry = entries_[scene];
  const bool ready =
      entry.coming.valid() && entry.coming.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  if (ready) entry.plan = entry.coming.get();
  const bool current = entry.time == time && entry.settings == options.settings();
  if (!current && !entry.coming.valid()) {
    entry.time = time, entry.settings = options.settings();
    entry.coming = std::async(std::launch::async, make, scene, options);
  }
  return entry.plan ? &*entry.plan : nullptr;
}

bool Plans::busy() const {
  return std::ranges::any_of(entries_, [](const auto& entry) {
    const auto& coming = entry.second.coming;
    return coming.valid() && coming.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
  });
}

}  // namespace lambent::editor
