// One volume from its density to codes: quantizing, rays, scattering, coding.
#pragma once

#include <span>
#include <vector>

#include "baker/bake/bake_group.hpp"

namespace lambent::baker {

// Whether it can be baked so: phase functions that ask for matrices have at most 6 bands of light, and what
// the runtime holds of their shaded samples lies in one page.
Result<void> checkVolume(const Scene& scene, const SceneVolume& volume, const BakeOptions& options);

// Bakes group `index` of the plan, a volume; `baked` holds the groups before it, those of surfaces among
// them. Errors: no memory for the hierarchy, "stopped".
Result<BakedGroup> bakeVolume(const SceneBake& bake, const AlphaMaps& alpha_maps, std::size_t index,
                              const std::vector<BakedGroup>& baked, const BakeContext& context);

// Density as it ships.
struct QuantizedDensity {
  std::uint32_t bits = 8;
  float largest = 0.0f;          // m^-1, of the largest code
  std::vector<std::byte> codes;  // as bundle::VolumeGrid has them
  std::vector<float> values;     // what the codes mean
  double error = 0.0;            // RMS over voxels that hold anything, relative to their RMS
};
// 8 bits where that keeps the error under 0.5 %, else 16 (2e-5 of the largest).
QuantizedDensity quantizeDensity(std::span<const float> density);

// The volume of a group as it ships, all but its transfer.
BakedVolume placeVolume(const Scene& scene, const RigidGroup& group, const QuantizedDensity& density);

}  // namespace lambent::baker
