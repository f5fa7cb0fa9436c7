#include "baker/decisions/decisions.hpp"

#include <optional>
#include <utility>

#include <fmt/format.h>

#include "baker/plan/counted.hpp"
#include "baker/plan/group_lights.hpp"
#include "baker/plan/smooth_dielectrics.hpp"
#include "baker/trace/mirror_paths.hpp"

namespace lambent::baker {

namespace {

Decision absent(const char* effect, std::string reason) {
  return {.effect = effect, .choice = Choice::Absent, .reason = std::move(reason)};
}

// The share of a highlight that the bands of matrices carry.
Figure carriedBy(const gltf::Material& material, int bands) {
  return {"carriedHighlight", 100.0 * lobeEnergyShare(double{material.roughness}, bands), "%"};
}

Decision matrices(const gltf::Material& material, const BakeOptions& options, bool glossy) {
  if (material.isDiffuse())
    return absent("matrices", "roughness 1 or no specular reflection: 0 % of a highlight");
  const Figure carried = carriedBy(material, options.glossy_order);
  Decision d{.effect = "matrices", .choice = Choice::Baked};
  if (!hasMatrices(material)) {
    d.choice = Choice::LeftOut;
    d.reason = "the specular layer shows this highlight instead";
  } else if (!glossy) {
    d.choice = Choice::LeftOut;
    d.reason = fmt::format("--effects {} leaves them out, with {} of this highlight", options.effects,
                           percentText(carried.value / 100.0));
  } else {
    d.reason = fmt::format("order {} carries {} of this highlight", options.glossy_order,
                           percentText(carried.value / 100.0));
  }
  d.figures = {carried, {"roughness", double{material.roughness}, ""}};
  return d;
}

Decision specularLayer(const gltf::Material& material, const BakeOptions& options, bool glossy) {
  if (!isSmoothDielectric(material) || !glossy)
    return absent("specularLayer", hasMatrices(material) && glossy
                                       ? "matrices carry its highlight"
                                       : "0 % of its light is a highlight of a layer");
  const Figure carried = carriedBy(material, options.glossy_order);
  Decision d{.effect = "specularLayer",
             .choice = Choice::Baked,
             .reason = fmt::format("order {} of matrices would carry {} of this highlight",
                                   options.glossy_order, percentText(carried.value / 100.0))};
  d.figures = {carried, {"roughness", double{material.roughness}, ""}};
  return d;
}

Decision mirrorPaths(const gltf::Material& material, const PlannedTransport& planned, bool glossy) {
  if (!hasMatrices(material) || !glossy || material.roughness >= kMirrorRoughness)
    return absent("mirrorPaths",
                  fmt::format("only light that metals of roughness under {:.2f} send on is followed",
                              double{kMirrorRoughness}));
  Decision d{
      .effect = "mirrorPaths",
      .choice = planned.bounces ? Choice::Baked : Choice::LeftOut,
      .reason = planned.bounces
                    ? fmt::format("its roughness of {:.2g} is under {:.2f}: rays that meet it are followed",
                                  double{material.roughness}, double{kMirrorRoughness})
                    : planned.bounces_reason};
  d.figures = {{"roughness", double{material.roughness}, ""}};
  return d;
}

Decision normalMap(const gltf::Material& material, bool glossy) {
  if (material.unlit || material.normal_texture.texture < 0)
    return absent("normalMap", "0 normal maps: a vector for one normal");
  if (hasMatrices(material) && glossy) return absent("normalMap", "matrices serve any normal");
  return {.effect = "normalMap",
          .choice = Choice::Baked,
          .reason = "3 bands of light for any normal in place of a vector",
          .figures = {{"bands", 3.0, "bands"}}};
}

Decision texels(const ScenePrimitive& primitive) {
  if (primitive.texels == 0) return absent("texels", "the author asks for 0 texels: transfer at vertices");
  return {.effect = "texels",
          .choice = Choice::Baked,
          .reason = fmt::format("the author asks for {0} x {0} texels", primitive.texels),
          .figures = {{"side", static_cast<double>(primitive.texels), "texels"}}};
}

// Returns nothing for the back itself. A back that is baked follows its front.
std::optional<Decision> backs(const RigidGroup& group, std::size_t draw, const gltf::Material& material) {
  if (group.draws[draw].back) return std::nullopt;
  if (!material.double_sided) return absent("backs", "0 double-sided materials: it is seen from its front");
  if (draw + 1 < group.draws.size() && group.draws[draw + 1].back)
    return Decision{.effect = "backs", .choice = Choice::Baked, .reason = "both sides may be seen"};
  return Decision{
      .effect = "backs", .choice = Choice::LeftOut, .reason = "its parts are closed and have nothing within"};
}

}  // namespace

std::vector<Decision> primitiveDecisions(const Decided& decided, std::size_t group, std::size_t draw) {
  const PlannedDraw& planned = decided.plan.groups[group].draws[draw];
  const ScenePrimitive& primitive = decided.scene.meshes[planned.mesh].primitives[planned.primitive];
  const gltf::Material material = primitive.material < 0
                                      ? gltf::Material{}
                                      : decided.scene.materials[static_cast<std::size_t>(primitive.material)];
  const PlannedTransport& transport = decided.plan.transport[group];
  const bool glossy = decided.plan.bakes("glossy") && primitive.material >= 0;
  std::vector<Decision> all;
  if (auto back = backs(decided.plan.groups[group], draw, material)) all.push_back(std::move(*back));
  if (primitive.material < 0) {
    all.push_back(absent("matrices", "0 materials: it is white and diffuse"));
  } else {
    all.push_back(matrices(material, decided.options, glossy));
    all.push_back(specularLayer(material, decided.options, glossy));
    all.push_back(mirrorPaths(material, transport, glossy));
    all.push_back(normalMap(material, glossy));
  }
  all.push_back(texels(primitive));
  return all;
}

namespace {

Decision groupShadows(const PlannedTransport& planned) {
  Decision d{.effect = "shadows",
             .choice = planned.shadows ? Choice::Baked : Choice::LeftOut,
             .reason = planned.shadows_reason};
  if (planned.height >= 0.0) d.figures = {{"heightAboveFaces", 100.0 * planned.height, "% of the diagonal"}};
  return d;
}

Decision groupInterreflection(const BakeOptions& options, const PlannedTransport& planned) {
  const std::size_t most =
      options.bounces < 0 ? BakeOptions::kMostBounces : static_cast<std::size_t>(options.bounces);
  const bool baked = planned.bounces && most > 0;
  Decision d{.effect = "interreflection",
             .choice = baked ? Choice::Baked : Choice::LeftOut,
             .reason = !baked
                           ? planned.bounces ? "--bounces 0" : planned.bounces_reason
                           : fmt::format("{}: at most {}", planned.bounces_reason, counted(most, "bounce"))};
  d.figures = {{"mostReflected", 100.0 * planned.most_reflected, "%"}};
  if (baked) d.figures.push_back({"mostBounces", static_cast<double>(most), "bounces"});
  return d;
}

Decision lamps(const Scene& scene, const RigidGroup& group) {
  const auto lights = findGroupLights(scene, group);
  std::size_t punctual = 0, spheres = 0;
  for (const PlannedLight& light : lights) {
    punctual += light.kind == PlannedLight::Kind::Node;
    spheres += !light.spheres.empty();
  }
  Decision d{.effect = "lamps",
             .choice = lights.empty() ? Choice::Absent : Choice::Baked,
             .reason = lights.empty()
                           ? "0 materials and nodes of the group give off light"
                           : fmt::format(
                                 "{} in a column of transfer each: {} of nodes, {} of which shine as spheres",
                                 counted(lights.size(), "light"), punctual, spheres)};
  d.figures = {{"lights", static_cast<double>(lights.size()), "columns"}};
  return d;
}

Decision refinement(const Decided& decided, std::size_t group) {
  const double bound = double{decided.options.effectiveRefineBound()};
  const bool shadows = decided.plan.transport[group].shadows;
  Decision d{.effect = "refinement", .choice = Choice::Baked};
  if (bound > 0.0 && shadows) {
    d.reason = fmt::format("edges are split until interpolation errs by {} where shadows change",
                           percentText(bound));
  } else {
    d.choice = Choice::LeftOut;
    d.reason = shadows ? "--refine off: 0 edges are split" : "0 shadows change between its vertices";
  }
  d.figures = {{"bound", 100.0 * bound, "%"}};
  return d;
}

Decision lightProbes(const PlannedLightProbes& planned) {
  Decision d{.effect = "lightProbes",
             .choice = Choice::Baked,
             .reason = fmt::format("{}{}: {}", counted(planned.count.count, "light probe"),
                                   planned.count.of_group ? "" : " in each cell", planned.reason)};
  d.figures = {{"lightProbes", static_cast<double>(planned.count.count),
                planned.count.of_group ? "of the group" : "of each cell"}};
  return d;
}

Decision neighborhood(const PlannedNeighborhood& planned) {
  Decision d{.effect = "neighborhood",
             .choice = planned.baked            ? Choice::Baked
                       : planned.reason.empty() ? Choice::Absent
                                                : Choice::LeftOut,
             .reason = planned.baked
                           ? fmt::format("{} within reach: {}", counted(planned.receivers.size(), "receiver"),
                                         planned.reason)
                       : planned.reason.empty() ? "0 larger groups have it within their bounds"
                                                : planned.reason};
  d.figures = {{"receivers", static_cast<double>(planned.receivers.size()), "groups"}};
  return d;
}

std::vector<Decision> groupDecisions(const Decided& decided, std::size_t g) {
  const EffectPlan& plan = decided.plan;
  const RigidGroup& group = plan.groups[g];
  std::vector<Decision> all;
  Decision volume{.effect = "volume",
                  .choice = group.volume < 0 ? Choice::Absent : Choice::Baked,
                  .reason = group.volume < 0 ? "0 media: it is a group of surfaces" : "1 medium"};
  if (group.volume < 0) {
    all = {groupShadows(plan.transport[g]), groupInterreflection(decided.options, plan.transport[g]),
           lamps(decided.scene, group), refinement(decided, g)};
  }
  all.push_back(lightProbes(plan.light_probes[g]));
  all.push_back(neighborhood(plan.neighborhoods[g]));
  all.push_back(std::move(volume));
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
