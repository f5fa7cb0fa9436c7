// The list of effects, and which of them a scene needs. A new effect adds a row here and its room in
// baker/effects; on the runtime's side it adds its room and its calls in runtime/frame/frame.cpp.
#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "baker/plan/counted.hpp"
#include "baker/plan/effect_plan.hpp"
#include "baker/plan/group_lights.hpp"
#include "baker/plan/neighborhoods.hpp"
#include "baker/plan/smooth_dielectrics.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {

namespace {

// Diffuse transfer is chosen for every scene with a surface.
EffectChoice chooseDiffuse(const Scene& scene, const std::vector<RigidGroup>& groups) {
  std::size_t draws = 0, mapped = 0, lights = 0;
  for (const RigidGroup& group : groups) {
    draws += group.draws.size();
    lights += findGroupLights(scene, group).size();
    for (const PlannedDraw& draw : group.draws) {
      const std::int32_t material = scene.meshes[draw.mesh].primitives[draw.primitive].material;
      mapped +=
          material >= 0 && scene.materials[static_cast<std::size_t>(material)].normal_texture.texture >= 0;
    }
  }
  if (draws == 0) return {"diffuse", false, "there are no surfaces"};
  std::string reason =
      fmt::format("{} of surfaces in {}", counted(draws, "draw"), counted(groups.size(), "rigid group"));
  if (lights > 0) reason += fmt::format("; {} of their own", counted(lights, "light"));
  if (mapped > 0) reason += fmt::format("; {} with a normal map", counted(mapped, "draw"));
  return {"diffuse", true, reason};
}

// Every scene with a surface that is not diffuse calls for glossy transfer.
EffectChoice chooseGlossy(const Scene& scene, const std::vector<RigidGroup>& groups) {
  constexpr int kOrder = 5;  // the default; nine tenths of the energy of lobes rougher than kRoughEnough
  constexpr float kRoughEnough = 0.5f;
  // Draws with matrices; those smoother than kRoughEnough, and others that a texture may make so.
  std::size_t draws = 0, metallic = 0, dielectric = 0, anisotropic = 0, measured = 0, smooth = 0,
              textured = 0;
  std::size_t layered = 0;  // draws of smooth dielectrics, which have none
  float smoothest = 1.0f, smoothest_layer = 1.0f, roughest_layer = 0.0f;
  for (const RigidGroup& group : groups)
    for (const PlannedDraw& draw : group.draws) {
      const std::int32_t index = scene.meshes[draw.mesh].primitives[draw.primitive].material;
      if (index < 0) continue;
      const gltf::Material& material = scene.materials[static_cast<std::size_t>(index)];
      if (isSmoothDielectric(material)) {
        ++layered;
        smoothest_layer = std::min(smoothest_layer, material.roughness);
        roughest_layer = std::max(roughest_layer, material.roughness);
      }
      if (!hasMatrices(material)) continue;
      ++draws;
      const bundle::BrdfFamily family = bundle::brdfFamilyOf(material);
      measured += family == bundle::BrdfFamily::Measured;
      anisotropic += family == bundle::BrdfFamily::AnisotropicGgx;
      if (family == bundle::BrdfFamily::Measured) continue;
      ++(material.metallic > 0.0f ? metallic : dielectric);
      if (material.roughness < kRoughEnough)
        ++smooth, smoothest = std::min(smoothest, material.roughness);
      else
        textured += material.metallic_roughness_texture.texture >= 0;
    }
  const auto percent = [](float roughness) {
    return fmt::format("{:.0f}", 100.0 * lobeEnergyShare(double{roughness}, kOrder));
  };
  std::vector<std::string> reasons;
  if (draws > 0) {
    std::vector<std::string> kinds;
    for (const auto& [count, what] : {std::pair(metallic, "metallic"),
                                      {dielectric, "dielectric"},
                                      {anisotropic, "anisotropic"},
                                      {measured, "measured"}})
      if (count > 0) kinds.push_back(fmt::format("{} {}", count, what));
    reasons.push_back(fmt::format("{} not diffuse ({}): {} x {} transfer matrices for any light and view",
                                  counted(draws, "draw") + (draws == 1 ? " is" : " are"),
                                  fmt::join(kinds, ", "), kOrder * kOrder, kOrder * kOrder));
  }
  if (smooth > 0)
    reasons.push_back(fmt::format(
        "{} with roughness below {}, down to {:.2g}, where order {} carries {} % of the highlight's energy",
        counted(smooth, "draw"), kRoughEnough, double{smoothest}, kOrder, percent(smoothest)));
  if (textured > 0)
    reasons.push_back(
        fmt::format("{} whose roughness texture may go below {}", counted(textured, "draw"), kRoughEnough));
  if (layered > 0) {
    const std::string least = percent(smoothest_layer), most = percent(roughest_layer);
    reasons.push_back(fmt::format(
        "{} of smooth dielectrics, of whose highlights order {} carries {} %: diffuse transfer and the "
        "prefiltered environment instead",
        counted(layered, "draw"), kOrder, least == most ? least : least + " to " + most));
  }
  if (reasons.empty()) return {"glossy", false, "every material is diffuse"};
  return {"glossy", true, fmt::format("{}", fmt::join(reasons, "; "))};
}

// Volumes are chosen for every scene with a volume.
EffectChoice chooseVolume(const Scene& scene, const std::vector<RigidGroup>&) {
  if (scene.volumes.empty()) return {"volume", false, "no node has a volume"};
  std::vector<std::string> each;
  for (const SceneVolume& volume : scene.volumes) {
    const glm::vec3& w = volume.albedo;
    const bool grey = w.r == w.g && w.g == w.b;
    each.push_back(fmt::format(
        "{} ({} x {} x {} voxels, albedo {})", volume.name, volume.size.x, volume.size.y, volume.size.z,
        grey ? fmt::format("{:.3g}", double{w.r})
             : fmt::format("{:.3g} {:.3g} {:.3g}", double{w.r}, double{w.g}, double{w.b})));
  }
  return {"volume", true,
          fmt::format("{}, light that comes through and that is scattered: {}",
                      counted(scene.volumes.size(), "volume"), fmt::join(each, "; "))};
}

// Neighborhoods are chosen for groups that baker/plan/neighborhoods.hpp chooses.
EffectChoice chooseNeighborhood(const Scene& scene, const std::vector<RigidGroup>& groups) {
  const std::vector<PlannedNeighborhood> plans = planNeighborhoods(scene, groups);
  std::vector<std::string> names;
  std::string against;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    if (plans[k].baked)
      names.push_back(groups[k].name);
    else if (against.empty() && !plans[k].reason.empty())
      against = fmt::format("{}: {}", groups[k].name, plans[k].reason);
  }
  if (names.empty())
    return {
        "neighborhood", false,
        against.empty() ? "no body comes within the bounds of a group of more than twice its size" : against};
  return {
      "neighborhood", true,
      fmt::format("grids of matrices around {}: their shadows, and light that they reflect, on what comes "
                  "near",
                  fmt::join(names, ", "))};
}

constexpr EffectEntry kEffects[] = {
    {"diffuse", chooseDiffuse},
    {"glossy", chooseGlossy},
    {"volume", chooseVolume},
    {"neighborhood", chooseNeighborhood},
};

}  // namespace

Result<std::vector<EffectEntry>> effectsNamed(std::string_view words) {
  if (words == "auto" || words == "all")
    return std::vector<EffectEntry>(std::begin(kEffects), std::end(kEffects));
  std::vector<EffectEntry> chosen;
  for (std::size_t begin = 0; begin <= words.size();) {
    const std::size_t end = std::min(words.find(',', begin), words.size());
    const std::string_view name = words.substr(begin, end - begin);
    const auto* const found = std::ranges::find(kEffects, name, &EffectEntry::name);
    if (found == std::end(kEffects)) {
      std::vector<std::string_view> known;
      for (const EffectEntry& entry : kEffects) known.push_back(entry.name);
      return fail("--effects", fmt::format("\"{}\" is not an effect", name),
                  fmt::format("use auto, all or a list of: {}", fmt::join(known, ", ")));
    }
    chosen.push_back(*found);
    begin = end + 1;
  }
  return chosen;
}

}  // namespace lambent::baker
