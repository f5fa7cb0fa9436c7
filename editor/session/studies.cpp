#include "editor/session/studies.hpp"

#include <algorithm>
#include <utility>

#include "baker/bake/bake.hpp"
#include "baker/import/gltf.hpp"
#include "editor/session/session.hpp"
#include "runtime/frame/frame_settings.hpp"

namespace lambent::editor {

void SettingStudy::measureAll() {
  waiting_.clear();
  for (const frame::SettingRow& row : frame::settingRows())
    if (row.finest) waiting_.insert(waiting_.begin(), std::string(row.name));
}

void SettingStudy::update(Session& session) {
  if (waiting_.empty() || !session.atRest()) return;
  const frame::SettingRow* row = frame::findSetting(waiting_.back());
  waiting_.pop_back();
  const spec::Size whole = session.viewing.size;
  const spec::Size size{320, std::max(1u, 320 * whole.height / std::max(1u, whole.width))};
  Stage& stage = session.stage;
  auto cost = frame::measureSetting({stage.world(), stage.environment(), session.viewing.shown_view},
                                    stage.settings(), *row, {.size = size, .repeats = 3});
  if (cost)
    costs_[std::string(row->name)] = std::move(*cost);
  else
    session.log.error(cost.error());
  session.viewing.changed = true;
}

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
