#include "baker/plan/effect_plan.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "baker/plan/closed_bodies.hpp"

namespace lambent::baker {

namespace {

std::string nameOf(const Scene& scene, std::size_t node) {
  const std::string& name = scene.nodes[node].name;
  return name.empty() ? fmt::format("node {}", node) : name;
}

// Transfer holds for directions, so a group may turn and scale uniformly, but not be stretched.
bool stretches(const gltf::AnimationChannel& channel, const gltf::Node& node) {
  if (channel.path != gltf::AnimationChannel::Path::Scale) return false;
  const bool cubic = channel.interpolation == gltf::AnimationChannel::Interpolation::Cubic;
  const auto key = [&](std::size_t i) {
    const float* v = &channel.values[cubic ? 9 * i + 3 : 3 * i];
    return glm::dvec3(v[0], v[1], v[2]);
  };
  glm::dvec3 rest = node.trs ? glm::dvec3(node.trs->scale) : glm::dvec3(0.0);
  if (rest == glm::dvec3(0.0)) rest = key(0);
  for (std::size_t i = 0; i < channel.times_s.size(); ++i) {
    const glm::dvec3 scale = key(i);
    if (glm::length(glm::cross(rest, scale)) > 1e-4 * glm::length(rest) * glm::length(scale)) return true;
  }
  return false;
}

void addStretchedNodes(const Scene& scene, std::vector<std::string>& sentences) {
  for (const gltf::Animation& animation : scene.animations)
    for (const gltf::AnimationChannel& channel : animation.channels)
      if (stretches(channel, scene.nodes[channel.node]))
        sentences.push_back(
            fmt::format("An animation stretches {}: its transfer stays that of its shape at rest.",
                        nameOf(scene, channel.node)));
}

// Lists what this version does not carry yet, so that nobody has to find out by looking at the picture.
std::vector<std::string> leftOut(const Scene& scene, bool glossy) {
  std::vector<std::string> sentences = scene.warnings;
  const auto any_material = [&](auto test) {
    return std::any_of(scene.materials.begin(), scene.materials.end(), test);
  };
  if (!glossy && any_material([](const gltf::Material& m) { return !m.isDiffuse(); }))
    sentences.emplace_back(
        "Metallic and glossy reflection are left out: every material is Lambert with albedo = base color.");
  if (any_material([](const gltf::Material& m) { return m.alpha_mode == gltf::AlphaMode::Blend; }))
    sentences.emplace_back("Materials with alphaMode BLEND cast no shadow.");
  if (any_material([](const gltf::Material& m) { return m.transmits(); }))
    sentences.emplace_back(
        "Panes (KHR_materials_transmission) pass light straight on; shadows of key lights and lamps ignore "
        "them.");
  addStretchedNodes(scene, sentences);
  return sentences;
}

}  // namespace

EffectPlan makePlan(const Scene& scene, std::span<const EffectEntry> effects, bool with_insides) {
  EffectPlan plan;
  plan.groups = findRigidGroups(scene);
  if (!with_insides) leaveOutInsides(scene, plan.groups);
  for (const EffectEntry& entry : effects) plan.effects.push_back(entry.choose(scene, plan.groups));
  plan.transport = planTransport(scene, plan.groups);
  if (plan.bakes("neighborhood"))
    plan.neighborhoods = planNeighborhoods(scene, plan.groups);
  else
    plan.neighborhoods.resize(plan.groups.size());
  plan.light_probes = planLightProbes(scene, plan.groups, plan.neighborhoods);
  plan.shadowed_lights = lightsInside(scene, plan.groups);
  plan.left_out = leftOut(scene, plan.bakes("glossy"));
  return plan;
}

bool EffectPlan::bakes(std::string_view effect) const {
  return std::any_of(effects.begin(), effects.end(),
                     [&](const EffectChoice& choice) { return choice.effect == effect && choice.baked; });
}

}  // namespace lambent::baker
