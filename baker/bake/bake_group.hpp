// One rigid group from its decoded meshes to codes: samples, rays, bounces, coding.
#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "baker/bake/bake.hpp"
#include "baker/bake/ship_meshes.hpp"
#include "baker/brdf/surface_brdfs.hpp"
#include "baker/compress/baked_grids.hpp"
#include "baker/compress/cpca.hpp"
#include "baker/light_probes/light_probes.hpp"
#include "baker/plan/group_lights.hpp"
#include "baker/transport/alpha_map.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/bundle/capture_proxy.hpp"

namespace lambent::baker {

struct BakedGroup {
  GroupGeometry geometry;  // draws and bounds are used here
  SampleSet samples;
  std::vector<PlannedLight> lights;
  // Per sample cell: light of the environment (of a glossy cell visibility, then bounced light), then, where
  // there are some, of the group's lights.
  std::vector<std::vector<CodedTransfer>> cells;
  LightProbes light_probes;           // as SampleSet::positions
  bundle::CaptureProxy proxy;         // group frame
  std::optional<BakedVolume> volume;  // then all of the above is empty
  std::optional<BakedNeighborhood> neighborhood;
};

// Glossy samples that a group may have: what the runtime holds of them lies in one page.
std::size_t mostGlossySamples(int glossy_order);

// tables: of the scene's glossy materials; empty where all are shown as Lambert. Adds what it did to the
// report. cache: may be null; what was done before with the same inputs is found there. Errors: no memory for
// the hierarchy, images that cannot be decoded, "stopped".
Result<BakedGroup> bakeGroup(const Scene& scene, const RigidGroup& group, LightProbeCount light_probes,
                             const PlannedNeighborhood& neighborhood, const BrdfTables& tables,
                             const ShippedMeshes& meshes,
                             const std::vector<std::shared_ptr<const AlphaMap>>& alpha_maps,
                             DecodedImages& images, const BakeOptions& options, Progress& progress,
                             const std::stop_token& stop, BakeReport& report, Cache* cache = nullptr);

}  // namespace lambent::baker
