// Bakes one volume, from its density to codes: quantization, rays, scattering, coding.
#pragma once

#include <span>
#include <vector>

#include "baker/bake/bake_group.hpp"

namespace lambent::baker {

// Checks whether the volume can be baked. Errors: a phase function that needs matrices with more than 6 bands
// of light, or shaded samples that do not fit into one page of the runtime.
Result<void> checkVolume(const Scene& scene, const SceneVolume& volume, const BakeOptions& options);

// Bakes group `index` of the plan, which is a volume. `baked` holds the groups before it, among them all
// those of surfaces. Errors: no memory for the ray hierarchy, "stopped".
Result<BakedGroup> bakeVolume(const SceneBake& bake, const AlphaMaps& alpha_maps, std::size_t index,
                              const std::vector<BakedGroup>& baked, const BakeContext& context);

// A QuantizedDensity is the density as the bundle stores it.
struct QuantizedDensity {
  std::uint32_t bits = 8;
  float largest = 0.0f;          // m^-1, density of the largest code
  std::vector<std::byte> codes;  // as in bundle::VolumeGrid
  std::vector<float> values;     // m^-1, densities that the codes stand for
  double error = 0.0;            // RMS over voxels with density, relative to their RMS
};
// Uses 8 bits if that keeps the error under 0.5 %, else 16 (2e-5 of the largest density).
QuantizedDensity quantizeDensity(std::span<const float> density);

// Returns the volume of a group as the bundle stores it, without its transfer.
BakedVolume placeVolume(const Scene& scene, const RigidGroup& group, const QuantizedDensity& density);

}  // namespace lambent::baker
