#include "baker/decisions/decisions.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "baker/plan/counted.hpp"
#include "baker/plan/group_lights.hpp"
#include "baker/plan/smooth_dielectrics.hpp"
#include "baker/trace/mirror_paths.hpp"

namespace lambent::baker {

namespace {

Choice bakedIf(bool baked, Choice otherwise = Choice::LeftOut) {
  return baked ? Choice::Baked : otherwise;
}

Decision groupInterreflection(const BakeOptions& options, const PlannedTransport& planned) {
  const std::size_t most =
      options.bounces < 0 ? BakeOptions::kMostBounces : static_cast<std::size_t>(options.bounces);
  if (!planned.bounces) return {"interreflection", Choice::LeftOut, planned.bounces_reason};
  if (most == 0) return {"interreflection", Choice::LeftOut, "--bounces 0"};
  return {"interreflection", Choice::Baked,
          fmt::format("{}: at most {}", planned.bounces_reason, counted(most, "bounce"))};
}

Decision lamps(const Scene& scene, const RigidGroup& group) {
  const auto lights = findGroupLights(scene, group);
  if (lights.empty()) return {"lamps", Choice::Absent, "0 materials and nodes of the group give off light"};
  const auto punctual = std::ranges::count(lights, PlannedLight::Kind::Node, &PlannedLight::kind);
  const auto spheres =
      std::ranges::count(lights, false, [](const auto& light) { return light.spheres.empty(); });
  return {"lamps", Choice::Baked,
          fmt::format("{} in a column of transfer each: {} of nodes, {} of which shine as spheres",
                      counted(lights.size(), "light"), punctual, spheres)};
}

Decision refinement(const BakeOptions& options, bool shadows) {
  const double bound = double{options.effectiveRefineBound()};
  if (!shadows) return {"refinement", Choice::LeftOut, "0 shadows change between its vertices"};
  if (!(bound > 0.0)) return {"refinement", Choice::LeftOut, "--refine off: 0 edges are split"};
  return {
      "refinement", Choice::Baked,
      fmt::format("edges are split until interpolation errs by {} where shadows change", percentText(bound))};
}

Decision lightProbes(const PlannedLightProbes& planned) {
  const auto [count, of_group] = planned.count;
  return {"lightProbes", Choice::Baked,
          fmt::format("{}{}: {}", counted(count, "light probe"), of_group ? "" : " in each cell",
                      planned.reason)};
}

Decision neighborhood(const PlannedNeighborhood& planned) {
  if (planned.baked)
    return {
        "neighborhood", Choice::Baked,
        fmt::format("{} within reach: {}", counted(planned.receivers.size(), "receiver"), planned.reason)};
  if (planned.reason.empty())
    return {"neighborhood", Choice::Absent, "0 larger groups have it within their bounds"};
  return {"neighborhood", Choice::LeftOut, planned.reason};
}

std::vector<Decision> groupDecisions(const Decided& decided, std::size_t g) {
  const EffectPlan& plan = decided.plan;
  const RigidGroup& group = plan.groups[g];
  const bool surfaces = group.volume < 0;
  std::vector<Decision> all;
  if (surfaces)
    all = {{"shadows", bakedIf(plan.transport[g].shadows), plan.transport[g].shadows_reason},
           groupInterreflection(decided.options, plan.transport[g]),
           lamps(decided.scene, group),
           refinement(decided.options, plan.transport[g].shadows)};
  all.push_back(lightProbes(plan.light_probes[g]));
  all.push_back(neighborhood(plan.neighborhoods[g]));
  all.push_back({"volume", bakedIf(!surfaces, Choice::Absent),
                 surfaces ? "0 media: it is a group of surfaces" : "1 medium"});
  return all;
}

// Returns the share of a highlight that the bands of matrices carry.
std::string carriedOf(const gltf::Material& material, const BakeOptions& options) {
  return percentText(lobeEnergyShare(double{material.roughness}, options.glossy_order));
}

Decision matrices(const gltf::Material& material, const BakeOptions& options, bool glossy) {
  if (material.isDiffuse())
    return {"matrices", Choice::Absent, "roughness 1 or no specular reflection: 0 % of a highlight"};
  if (!hasMatrices(material))
    return {"matrices", Choice::LeftOut, "the specular layer shows this highlight instead"};
  if (!glossy)
    return {"matrices", Choice::LeftOut,
            fmt::format("--effects {} leaves them out, with {} of this highlight", options.effects,
                        carriedOf(material, options))};
  return {"matrices", Choice::Baked,
          fmt::format("order {} carries {} of this highlight", options.glossy_order,
                      carriedOf(material, options))};
}

Decision specularLayer(const gltf::Material& material, const BakeOptions& options, bool glossy) {
  if (!isSmoothDielectric(material) || !glossy)
    return {"specularLayer", Choice::Absent,
            hasMatrices(material) && glossy ? "matrices carry its highlight"
                                            : "0 % of its light is a highlight of a layer"};
  return {"specularLayer", Choice::Baked,
          fmt::format("order {} of matrices would carry {} of this highlight", options.glossy_order,
                      carriedOf(material, options))};
}

Decision mirrorPaths(const gltf::Material& material, const PlannedTransport& planned, bool glossy) {
  const double roughness = double{material.roughness}, most = double{kMirrorRoughness};
  if (!hasMatrices(material) || !glossy || material.roughness >= kMirrorRoughness)
    return {"mirrorPaths", Choice::Absent,
            fmt::format("only light that metals of roughness under {:.2f} send on is followed", most)};
  if (!planned.bounces) return {"mirrorPaths", Choice::LeftOut, planned.bounces_reason};
  return {"mirrorPaths", Choice::Baked,
          fmt::format("its roughness of {:.2g} is under {:.2f}: rays that meet it are followed", roughness,
                      most)};
}

Decision normalMap(const gltf::Material& material, bool glossy) {
  if (material.unlit || material.normal_texture.texture < 0)
    return {"normalMap", Choice::Absent, "0 normal maps: a vector for one normal"};
  if (hasMatrices(material) && glossy) return {"normalMap", Choice::Absent, "matrices serve any normal"};
  return {"normalMap", Choice::Baked, "3 bands of light for any normal in place of a vector"};
}

Decision texels(const ScenePrimitive& primitive) {
  if (primitive.texels == 0)
    return {"texels", Choice::Absent, "the author asks for 0 texels: transfer at vertices"};
  return {"texels", Choice::Baked, fmt::format("the author asks for {0} x {0} texels", primitive.texels)};
}

// About a front. A back that is baked follows it.
Decision backs(const RigidGroup& group, std::size_t draw, const gltf::Material& material) {
  if (!material.double_sided)
    return {"backs", Choice::Absent, "0 double-sided materials: it is seen from its front"};
  const bool baked = draw + 1 < group.draws.size() && group.draws[draw + 1].back;
  return {"backs", bakedIf(baked),
          baked ? "both sides may be seen" : "its parts are closed and have nothing within"};
}

std::vector<Decision> primitiveDecisions(const Decided& decided, std::size_t group, std::size_t draw) {
  const PlannedDraw& planned = decided.plan.groups[group].draws[draw];
  const ScenePrimitive& primitive = decided.scene.meshes[planned.mesh].primitives[planned.primitive];
  const gltf::Material material = primitive.material < 0
                                      ? gltf::Material{}
                                      : decided.scene.materials[static_cast<std::size_t>(primitive.material)];
  const bool glossy = decided.plan.bakes("glossy") && primitive.material >= 0;
  std::vector<Decision> all;
  if (!planned.back) all.push_back(backs(decided.plan.groups[group], draw, material));
  if (primitive.material < 0) {
    all.push_back({"matrices", Choice::Absent, "0 materials: it is white and diffuse"});
  } else {
    all.push_back(matrices(material, decided.options, glossy));
    all.push_back(specularLayer(material, decided.options, glossy));
    all.push_back(mirrorPaths(material, decided.plan.transport[group], glossy));
    all.push_back(normalMap(material, glossy));
  }
  all.push_back(texels(primitive));
  return all;
}

}  // namespace

const char* choiceName(Choice choice) {
  switch (choice) {
    case Choice::Baked:
      return "baked";
    case Choice::LeftOut:
      return "leftOut";
    case Choice::Absent:
      break;
  }
  return "absent";
}

std::vector<GroupDecisions> decisionsOf(const Decided& decided) {
  std::vector<GroupDecisions> all;
  for (std::size_t g = 0; g < decided.plan.groups.size(); ++g) {
    GroupDecisions& of = all.emplace_back();
    of.decisions = groupDecisions(decided, g);
    for (std::size_t d = 0; d < decided.plan.groups[g].draws.size(); ++d)
      of.primitives.push_back({d, primitiveDecisions(decided, g, d)});
  }
  return all;
}

}  // namespace lambent::baker
