#include "baker/effects/effect_list.hpp"

#include <algorithm>
#include <map>
#include <ranges>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "baker/brdf/brdf.hpp"
#include "baker/plan/counted.hpp"
#include "baker/plan/group_lights.hpp"
#include "baker/plan/neighborhoods.hpp"
#include "baker/plan/smooth_dielectrics.hpp"

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

// The default order of bakes; it represents at least nine tenths of the energy of lobes rougher than
// kRoughEnough.
constexpr int kOrder = 5;
constexpr float kRoughEnough = 0.5f;

// Counts draws with matrices.
struct Counts {
  std::size_t draws = 0, metals = 0, dielectrics = 0;
  std::map<const BrdfKind*, std::size_t> of_kind;
  // Draws smoother than kRoughEnough, and other draws that a texture may make so.
  std::size_t smooth = 0, textured = 0;
  float smoothest = 1.0f;
};

// Counts draws of smooth dielectrics, which have none.
struct LayeredCounts {
  std::size_t draws = 0;
  float smoothest = 1.0f, roughest = 0.0f;
};

void count(const gltf::Material& material, Counts& counts) {
  ++counts.draws;
  const BrdfKind& kind = brdfKindOf(material);
  ++counts.of_kind[&kind];
  if (kind.family == bundle::BrdfFamily::Measured) return;
  ++(material.metallic > 0.0f ? counts.metals : counts.dielectrics);
  if (material.roughness < kRoughEnough) {
    ++counts.smooth;
    counts.smoothest = std::min(counts.smoothest, material.roughness);
  } else {
    counts.textured += material.metallic_roughness_texture.texture >= 0;
  }
}

void count(const gltf::Material& material, LayeredCounts& counts) {
  ++counts.draws;
  counts.smoothest = std::min(counts.smoothest, material.roughness);
  counts.roughest = std::max(counts.roughest, material.roughness);
}

double percentCarried(float roughness) {
  return 100.0 * lobeEnergyShare(double{roughness}, kOrder);
}

std::string drawsAre(std::size_t draws) {
  return counted(draws, "draw") + (draws == 1 ? " is" : " are");
}

std::string reasonOf(const Counts& counts) {
  std::vector<std::string> kinds;
  const auto name = [&](std::size_t n, const char* what) {
    if (n > 0) kinds.push_back(fmt::format("{} {}", n, what));
  };
  name(counts.metals, "metallic");
  name(counts.dielectrics, "dielectric");
  for (const BrdfKind& kind : brdfKinds() | std::views::reverse)
    if (const auto found = counts.of_kind.find(&kind);
        found != counts.of_kind.end() && kind.family != bundle::BrdfFamily::Ggx)
      name(found->second, kind.name);
  std::string reason =
      fmt::format("{} not diffuse ({}): {} transfer matrices for any light and view", drawsAre(counts.draws),
                  fmt::join(kinds, ", "), fmt::format("{0} x {0}", kOrder * kOrder));
  if (counts.smooth > 0)
    reason += fmt::format(
        "; {} with roughness below {}, down to {:.2g}, where order {} carries {:.0f} % of the "
        "highlight's energy",
        counted(counts.smooth, "draw"), kRoughEnough, double{counts.smoothest}, kOrder,
        percentCarried(counts.smoothest));
  if (counts.textured > 0)
    reason += fmt::format("; {} whose roughness texture may go below {}", counted(counts.textured, "draw"),
                          kRoughEnough);
  return reason;
}

std::string reasonOf(const LayeredCounts& counts) {
  const std::string least = fmt::format("{:.0f}", percentCarried(counts.smoothest)),
                    most = fmt::format("{:.0f}", percentCarried(counts.roughest));
  return fmt::format(
      "{} of smooth dielectrics, of whose highlights order {} carries {} %: diffuse transfer and the "
      "prefiltered environment instead",
      counted(counts.draws, "draw"), kOrder, least == most ? least : least + " to " + most);
}

// Every scene with a surface that is not diffuse calls for glossy transfer.
EffectChoice chooseGlossy(const Scene& scene, const std::vector<RigidGroup>& groups) {
  Counts counts;
  LayeredCounts layered;
  for (const RigidGroup& group : groups)
    for (const PlannedDraw& draw : group.draws) {
      const std::int32_t index = scene.meshes[draw.mesh].primitives[draw.primitive].material;
      if (index < 0) continue;
      const gltf::Material& material = scene.materials[static_cast<std::size_t>(index)];
      if (hasMatrices(material)) count(material, counts);
      if (isSmoothDielectric(material)) count(material, layered);
    }
  std::vector<std::string> reasons;
  if (counts.draws > 0) reasons.push_back(reasonOf(counts));
  if (layered.draws > 0) reasons.push_back(reasonOf(layered));
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

}  // namespace

std::span<const EffectEntry> effectList() {
  static constexpr EffectEntry kEffects[] = {
      {"diffuse", chooseDiffuse},
      {"glossy", chooseGlossy},
      {"volume", chooseVolume},
      {"neighborhood", chooseNeighborhood},
  };
  return kEffects;
}

Result<std::vector<EffectEntry>> effectsNamed(std::string_view words) {
  const auto all = effectList();
  if (words == "auto" || words == "all") return std::vector<EffectEntry>(all.begin(), all.end());
  std::vector<EffectEntry> chosen;
  for (std::size_t begin = 0; begin <= words.size();) {
    const std::size_t end = std::min(words.find(',', begin), words.size());
    const std::string_view name = words.substr(begin, end - begin);
    const auto found = std::ranges::find_if(all, [&](const EffectEntry& e) { return name == e.name; });
    if (found == all.end()) {
      std::string known;
      for (const EffectEntry& entry : all)
        known += fmt::format("{}{}", known.empty() ? "" : ", ", entry.name);
      return fail("--effects", fmt::format("\"{}\" is not an effect", name),
                  "use auto, all or a list of: " + known);
    }
    chosen.push_back(*found);
    begin = end + 1;
  }
  return chosen;
}

}  // namespace lambent::baker
