#include <optional>
#include <utility>

#include <fmt/format.h>

#include "baker/decisions/decisions.hpp"
#include "baker/plan/lobe_energy.hpp"
#include "baker/plan/smooth_dielectrics.hpp"
#include "baker/trace/mirror_paths.hpp"

namespace lambent::baker {

namespace {

Decision absent(const char* effect, std::string reason) {
  return {.effect = effect, .choice = Choice::Absent, .reason = std::move(reason), .saves = kSavesNothing};
}

Decision surfaceShadows(const PlannedTransport& planned, const SurfaceLook& look) {
  Decision d{
      .effect = "shadows",
      .choice = planned.shadows ? Choice::Baked : Choice::LeftOut,
      .reason = fmt::format("its group hides {:.2g} % of the sky's light from it", 100.0 * look.hidden)};
  d.figures = {{"hiddenLight", 100.0 * look.hidden, "%"}};
  return d;
}

Decision surfaceInterreflection(const PlannedTransport& planned, const BakeOptions& options,
                                const SurfaceLook& look) {
  Decision d{
      .effect = "interreflection",
      .choice = planned.bounces && options.bounces != 0 ? Choice::Baked : Choice::LeftOut,
      .reason = fmt::format("{:.2g} % of the light that arrives at it has bounced", 100.0 * look.bounced)};
  d.figures = {{"bouncedLight", 100.0 * look.bounced, "%"}};
  return d;
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
    d.reason = fmt::format("order {} carries {:.2g} % of this highlight: the specular layer shows it instead",
                           options.glossy_order, carried.value);
  } else if (!glossy) {
    d.choice = Choice::LeftOut;
    d.reason = fmt::format("--effects {} leaves them out, with {:.2g} % of this highlight", options.effects,
                           carried.value);
  } else {
    d.reason =
        fmt::format("order {} carries {:.2g} % of this highlight", options.glossy_order, carried.value);
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
  Decision d{
      .effect = "specularLayer",
      .choice = Choice::Baked,
      .reason = fmt::format("matrices: order {} carries {:.2g} % of this highlight: specular occlusion and "
                            "the prefiltered environment",
                            options.glossy_order, carried.value)};
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
    return Decision{.effect = "backs",
                    .choice = Choice::Baked,
                    .reason = "both sides of its faces may be seen, or are not known to be hidden"};
  return Decision{.effect = "backs",
                  .choice = Choice::LeftOut,
                  .reason = "each of its parts is closed and has nothing within: 0 % of its backs is seen"};
}

}  // namespace

std::vector<Decision> primitiveDecisions(const Decided& decided, std::size_t group, std::size_t draw) {
  const PlannedDraw& planned = decided.plan.groups[group].draws[draw];
  const ScenePrimitive& primitive = decided.scene.meshes[planned.mesh].primitives[planned.primitive];
  const gltf::Material material = primitive.material < 0
                                      ? gltf::Material{}
                                      : decided.scene.materials[static_cast<std::size_t>(primitive.material)];
  const PlannedTransport& transport = decided.plan.transport[group];
  const SurfaceLook& look = decided.looks[group].draws[draw];
  const bool glossy = decided.plan.bakes("glossy") && primitive.material >= 0;
  std::vector<Decision> all = {surfaceShadows(transport, look),
                               surfaceInterreflection(transport, decided.options, look)};
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

}  // namespace lambent::baker
