// Bakes one rigid group of surfaces, from its decoded meshes to codes: samples, rays, bounces, coding.
#pragma once

#include <optional>
#include <vector>

#include "baker/bake/group_scene.hpp"
#include "baker/compress/cpca.hpp"
#include "baker/compress/kept_transfer.hpp"
#include "baker/jobs/bake_context.hpp"
#include "baker/light_probes/light_probes.hpp"
#include "baker/plan/group_lights.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/bundle/capture_proxy.hpp"

namespace lambent::baker {

struct BakedGroup {
  GroupGeometry geometry;  // of which draws and bounds are used
  SampleSet samples;
  std::vector<PlannedLight> lights;
  std::vector<std::vector<CodedTransfer>> cells;  // as in SurfaceCells
  std::vector<std::uint8_t> importance;           // as in SurfaceCells
  std::optional<bundle::PictureError> picture_error;
  float codes_bound = 0.0f, glossy_codes_bound = 0.0f;
  LightProbes light_probes;           // in the frame of SampleSet::positions
  bundle::CaptureProxy proxy;         // group frame
  std::optional<BakedVolume> volume;  // if set, the members above are empty but for light_probes
  std::optional<BakedNeighborhood> neighborhood;
  BakeReport report;  // of this group
};

// Bakes group `index` of the plan, which is one of surfaces. Results of earlier runs with the same inputs are
// taken from the cache. Errors: no memory for the ray hierarchy, images that cannot be decoded, "stopped".
Result<BakedGroup> bakeGroup(const SceneBake& bake, const SurfaceInputs& inputs, std::size_t index,
                             const BakeContext& context);

}  // namespace lambent::baker
