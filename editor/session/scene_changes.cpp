#include "editor/session/scene_changes.hpp"

#include <set>

#include <fmt/format.h>
#include <glm/matrix.hpp>

#include "editor/document/document.hpp"
#include "runtime/base/finite.hpp"
#include "runtime/scene/affine.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/materials.hpp"
#include "runtime/world/material_rebake.hpp"

namespace lambent::editor {

bool samePlace(const glm::mat4& a, const glm::mat4& b) {
  constexpr float kRounding = 1e-5f, kMetre = 1.0f;
  float axes = 0.0f, place = kMetre;
  for (int row = 0; row < 3; ++row) {
    place = std::max(place, std::abs(b[3][row]));
    for (int column = 0; column < 3; ++column) axes = std::max(axes, std::abs(b[column][row]));
  }
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!(std::abs(a[column][row] - b[column][row]) <= kRounding * (column < 3 ? axes : place)))
        return false;
  return true;
}

void addNodeEdits(const ecs::Registry& registry, const bundle::Description& description,
                  const scene::SceneInstance& instance, baker::SceneEdits& edits) {
  for (std::uint32_t i = 0; i < description.nodes.size(); ++i) {
    const gltf::Node& node = description.nodes[i];
    const auto* transform = registry.tryGet<scene::Transform>(instance.nodes[i]);
    if (!transform || node.animated) continue;
    const ecs::Entity parent =
        node.parent < 0 ? instance.root : instance.nodes[static_cast<std::size_t>(node.parent)];
    glm::mat4 now = scene::localMatrix(*transform);
    if (transform->parent != parent)
      now = glm::mat4(glm::inverse(glm::dmat4(worldFromNode(registry, parent))) *
                      glm::dmat4(worldFromNode(registry, instance.nodes[i])));
    // Below a flat parent no Transform gives it that place; it stays where the scene has it.
    if (isFinite(now) && !samePlace(now, node.parent_from_node)) edits.nodes.push_back({i, node.name, now});
  }
}

namespace {

// Adds a sentence for each node that moved within its rigid group since the bake: the group's transfer still
// has it in the old place. A group that moved as a whole needs none.
void addMovedParts(const ecs::Registry& registry, const bundle::Description& description,
                   const scene::SceneInstance& instance, std::vector<std::string>& sentences) {
  const std::vector<glm::mat4> rest = gltf::worldTransforms(description.nodes);
  std::set<std::uint32_t> told;
  for (const bundle::Draw& draw : description.draws) {
    const auto* group = registry.tryGet<scene::RigidGroupComponent>(instance.groups[draw.group]);
    const auto* node = registry.tryGet<scene::WorldTransform>(instance.nodes[draw.node]);
    if (!group || !node || samePlace(node->world_from_node, group->world_from_rest * rest[draw.node]))
      continue;
    if (!told.insert(draw.node).second) continue;
    sentences.push_back(
        fmt::format("{}: moved within its rigid group, whose shadows and bounces still have it in "
                    "its old place",
                    description.nodes[draw.node].name));
  }
}

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
