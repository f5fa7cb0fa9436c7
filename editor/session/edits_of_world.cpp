// What of a bundle's entities differs from its file, as edits of the scene that it is baked from.
#include <algorithm>

#include "editor/session/node_edits.hpp"
#include "editor/session/session.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/materials.hpp"

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

baker::SceneEdits Session::editsOf(std::size_t entry) const {
  const SceneEntry& scene = scenes.entries()[entry];
  if (!scene.slot) return scene.edits;
  baker::SceneEdits edits;
  const ecs::Registry& registry = document.registry();
  const bundle::Description& description = stage.world().description(*scene.slot);
  const scene::SceneInstance& instance = stage.world().instance(*scene.slot);
  addNodeEdits(registry, description, instance, edits);
  addLights(registry, description, instance, edits);
  addMaterials(registry, description, instance, edits);
  // What is shown may have been baked with edits itself: those that were not edited again still hold.
  keepOthers(scene.shown_edits.nodes, edits.nodes, &baker::SceneEdits::Node::index);
  keepOthers(scene.shown_edits.lights, edits.lights, &baker::SceneEdits::Light::node);
  keepMaterials(scene.shown_edits.materials, edits.materials);
  return edits;
}

}  // namespace lambent::editor
