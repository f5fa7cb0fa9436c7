// One rigid group from its decoded meshes to codes: samples, rays, bounces, coding.
#pragma once

#include <optional>
#include <vector>

#include "baker/bake/scene_bake.hpp"
#include "baker/compress/baked_grids.hpp"
#include "baker/compress/cpca.hpp"
#include "baker/jobs/bake_context.hpp"
#include "baker/light_probes/light_probes.hpp"
#include "baker/plan/group_lights.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/bundle/capture_proxy.hpp"

namespace lambent::baker {

struct BakedGroup {
  GroupGeometry geometry;  // draws and bounds are used here
  SampleSet samples;
  std::vector<PlannedLight> lights;
  std::vector<std::vector<CodedTransfer>> cells;  // as SurfaceCells has them
  LightProbes light_probes;                       // as SampleSet::positions
  bundle::CaptureProxy proxy;                     // group frame
  std::optional<BakedVolume> volume;              // then all of the above is empty
  std::optional<BakedNeighborhood> neighborhood;
};

// Bakes group `index` of the plan, one of surfaces. What was done before with the same inputs is found in the
// cache. Errors: no memory for the hierarchy, images that cannot be decoded, "stopped".
Result<BakedGroup> bakeGroup(const SceneBake& bake, const SurfaceInputs& inputs, std::size_t index,
                             const BakeContext& context);

}  // namespace lambent::baker
