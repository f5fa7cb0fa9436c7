#include "editor/session/scene_changes.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "editor/session/moved_parts.hpp"
#include "editor/session/node_edits.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/materials.hpp"
#include "runtime/world/material_rebake.hpp"

namespace lambent::editor {

namespace {

void addLights(const ecs::Registry& registry, const bundle::Description& description,
               const scene::SceneInstance& instance, baker::SceneEdits& edits) {
  for (std::uint32_t i = 0; i < description.nodes.size(); ++i) {
    const gltf::Node& node = description.nodes[i];
    const auto* now = registry.tryGet<scene::LocalLightComponent>(instance.nodes[i]);
    if (!now || node.light < 0) continue;
    const gltf::Light& light = description.lights[static_cast<std::size_t>(node.light)];
    const float intensity = now->enabled ? now->strength : 0.0f;
    if (now->color == light.color && intensity == light.intensity && now->range_m == light.range_m &&
        now->inner_cone_rad == light.inner_cone_rad && now->outer_cone_rad == light.outer_cone_rad)
      continue;
    edits.lights.push_back(
        {i, node.name, now->color, intensity, now->range_m, now->inner_cone_rad, now->outer_cone_rad});
  }
}

void addMaterials(const ecs::Registry& registry, const bundle::Description& description,
                  const scene::SceneInstance& instance, baker::SceneEdits& edits) {
  for (std::uint32_t i = 0; i < instance.materials.size(); ++i) {
    const auto* now = registry.tryGet<scene::MaterialComponent>(instance.materials[i]);
    if (!now) continue;
    const gltf::Material& was = description.materials[i];
    baker::SceneEdits::Material edit = baker::editOf(i, was, scene::withComponent(was, *now));
    if (!edit.values.empty()) edits.materials.push_back(std::move(edit));
  }
}

template <typename Edit>
void keepOthers(const std::vector<Edit>& baked, std::vector<Edit>& edits, std::uint32_t Edit::*index) {
  for (const Edit& old : baked)
    if (std::none_of(edits.begin(), edits.end(), [&](const Edit& edit) { return edit.*index == old.*index; }))
      edits.push_back(old);
}

void keepMaterials(const std::vector<baker::SceneEdits::Material>& baked,
                   std::vector<baker::SceneEdits::Material>& edits) {
  for (const baker::SceneEdits::Material& old : baked) {
    const auto same =
        std::find_if(edits.begin(), edits.end(), [&](const auto& edit) { return edit.index == old.index; });
    if (same == edits.end())
      edits.push_back(old);
    else
      *same = baker::overlaid(old, *same);
  }
}

}  // namespace

const Baseline& SceneChanges::baseline() {
  std::vector<BaselineBundle> bundles;
  // A bundle that replaces another does so some frames after the scenes' version has risen.
  std::pair<std::uint64_t, std::vector<const void*>> of{scenes_.version(), {}};
  for (const SceneEntry& entry : scenes_.entries())
    if (entry.slot) {
      bundles.push_back({&world_.description(*entry.slot), entry.id, entry.instance});
      of.second.push_back(bundles.back().description);
    }
  if (of == baseline_of_) return baseline_;
  auto made = Baseline::create(bundles);
  if (made)
    baseline_ = std::move(*made);
  else
    log_.error(made.error());
  baseline_of_ = std::move(of);
  return baseline_;
}

baker::SceneEdits SceneChanges::editsOf(std::size_t entry) const {
  const SceneEntry& scene = scenes_.entries()[entry];
  if (!scene.slot) return scene.edits;
  baker::SceneEdits edits;
  const ecs::Registry& registry = world_.registry();
  const bundle::Description& description = world_.description(*scene.slot);
  const scene::SceneInstance& instance = world_.instance(*scene.slot);
  addNodeEdits(registry, description, instance, edits);
  addLights(registry, description, instance, edits);
  addMaterials(registry, description, instance, edits);
  // The bundle may itself have been baked with edits. Those that were not changed since still apply.
  keepOthers(scene.shown_edits.nodes, edits.nodes, &baker::SceneEdits::Node::index);
  keepOthers(scene.shown_edits.lights, edits.lights, &baker::SceneEdits::Light::node);
  keepMaterials(scene.shown_edits.materials, edits.materials);
  return edits;
}

std::vector<std::string> SceneChanges::needsRebake(std::size_t entry) const {
  std::vector<std::string> sentences;
  const SceneEntry& scene = scenes_.entries()[entry];
  if (!scene.slot) return sentences;
  const ecs::Registry& registry = world_.registry();
  const bundle::Description& description = world_.description(*scene.slot);
  const scene::SceneInstance& instance = world_.instance(*scene.slot);
  for (std::uint32_t i = 0; i < instance.materials.size(); ++i) {
    const auto* component = registry.tryGet<scene::MaterialComponent>(instance.materials[i]);
    if (!component) continue;
    const gltf::Material now = scene::withComponent(description.materials[i], *component);
    for (const frame::RebakeReason& reason :
         frame::needsRebake(now, description.materials[i], frame::materialUse(description, i)))
      sentences.push_back(fmt::format("{}: {}", description.materials[i].name, reason.sentence));
  }
  addMovedParts(registry, description, instance, sentences);
  return sentences;
}

const std::vector<std::string>& SceneChanges::needsRebakeNow(std::size_t entry) {
  if (rebakes_.size() <= entry) rebakes_.resize(entry + 1);
  Rebake& known = rebakes_[entry];
  // Until all is loaded, a bundle may replace another in any frame.
  const std::pair now{history_.version(), scenes_.version()};
  if (known.of_edits_and_scenes == now && world_.loaded()) return known.sentences;
  known.sentences = needsRebake(entry);
  known.of_edits_and_scenes = world_.loaded() ? std::optional(now) : std::nullopt;
  return known.sentences;
}

}  // namespace lambent::editor
