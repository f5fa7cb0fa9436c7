#include "baker/effects/glossy/glossy.hpp"

#include <algorithm>
#include <map>
#include <ranges>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "baker/brdf/brdf_kinds.hpp"
#include "baker/plan/counted.hpp"
#include "baker/plan/smooth_dielectrics.hpp"

namespace lambent::baker {

namespace {

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

}  // namespace

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

namespace {

// Returns the cell's part of a list with `size` values for each sample.
std::span<const float> partOf(const std::vector<float>& values, std::size_t size, std::size_t first,
                              std::size_t count) {
  return std::span(values).subspan(first * size, count * size);
}

bool anyIn(std::span<const float> values) {
  return std::any_of(values.begin(), values.end(), [](float value) { return value != 0.0f; });
}

}  // namespace

std::vector<CellVectors> glossyCellVectors(const SampleCell& cell, const GlossyField& field,
                                           bool grey_emission) {
  const auto order = static_cast<std::uint32_t>(field.order_in),
             outputs = static_cast<std::uint32_t>(field.order_out * field.order_out);
  const std::size_t first = cell.first - field.first_sample, count = cell.count;
  const auto copied = [](std::span<const float> part) {
    return std::vector<float>(part.begin(), part.end());
  };

  std::vector<CellVectors> out;
  const transfer::TransferShape visibility{
      .order = order,
      .outputs = outputs,
      .visibility_bands = static_cast<std::uint32_t>(field.visibilityBands())};
  out.push_back({visibility, copied(partOf(field.visibility, field.visibilitySize(), first, count))});

  const transfer::TransferShape bounced{
      .order = order, .shadowed_channels = 0, .full_channels = field.channels, .outputs = outputs};
  if (!field.bounced.empty())
    if (const auto part = partOf(field.bounced, bounced.size(), first, count); anyIn(part))
      out.push_back({bounced, copied(part)});

  if (field.light_columns == 0) return out;
  transfer::TransferShape lights{.order = 0,
                                 .light_columns = field.light_columns,
                                 .shadowed_channels = grey_emission ? 1 : field.channels,
                                 .full_channels = 0,
                                 .outputs = outputs};
  const std::size_t channel = std::size_t{outputs} * field.light_columns, size = field.channels * channel;
  const auto shadowed = partOf(field.lights_shadowed, size, first, count);
  std::span<const float> full;
  if (!field.lights_full.empty()) full = partOf(field.lights_full, size, first, count);
  if (!std::equal(full.begin(), full.end(), shadowed.begin())) lights.full_channels = field.channels;
  CellVectors vectors{lights, {}};
  vectors.vectors.reserve(count * lights.size());
  const auto append = [&](std::span<const float> from, std::size_t sample, std::uint32_t channels) {
    const auto own = from.subspan(sample * size, channels * channel);
    vectors.vectors.insert(vectors.vectors.end(), own.begin(), own.end());
  };
  for (std::size_t s = 0; s < count; ++s) {
    append(shadowed, s, lights.shadowed_channels);
    if (lights.full_channels > 0) append(full, s, lights.full_channels);
  }
  out.push_back(std::move(vectors));
  return out;
}

}  // namespace lambent::baker
