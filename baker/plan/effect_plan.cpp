#include "baker/plan/effect_plan.hpp"

#include <algorithm>

namespace lambent::baker {

namespace {

// What this version does not carry yet, so that nobody has to find out by looking at the picture.
std::vector<std::string> leftOut(const Scene& scene) {
  std::vector<std::string> sentences = scene.warnings;
  const auto any_material = [&](auto test) {
    return std::any_of(scene.materials.begin(), scene.materials.end(), test);
  };
  if (any_material([](const gltf::Material& m) { return m.metallic > 0.0f || m.roughness < 1.0f; }))
    sentences.emplace_back(
        "Metallic and glossy reflection are left out: every material is Lambert with albedo = base colour.");
  if (any_material([](const gltf::Material& m) { return m.emissive != glm::vec3(0.0f); }))
    sentences.emplace_back("Emissive materials do not shine: their light is left out.");
  if (any_material([](const gltf::Material& m) { return m.alpha_mode == gltf::AlphaMode::Blend; }))
    sentences.emplace_back("Materials with alphaMode BLEND cast no shadow.");
  if (std::any_of(scene.nodes.begin(), scene.nodes.end(), [](const gltf::Node& n) { return n.animated; }))
    sentences.emplace_back("Animations do not play: animated nodes are separate rigid groups, at rest.");
  return sentences;
}

}  // namespace

EffectPlan makePlan(const Scene& scene, std::span<const EffectEntry> effects) {
  EffectPlan plan;
  plan.groups = findRigidGroups(scene);
  for (const EffectEntry& entry : effects) plan.effects.push_back(entry.choose(scene, plan.groups));
  plan.left_out = leftOut(scene);
  if (plan.groups.size() > 1)
    plan.left_out.emplace_back(
        "Rigid groups do not shadow or light each other yet: each is baked by itself.");
  return plan;
}

}  // namespace lambent::baker
