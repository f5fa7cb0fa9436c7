// One rigid group of surfaces as its effects share it: its geometry, where it is sampled, its lights, the
// keys under which its results are kept; and, once something has to be computed, its colours, its BRDFs and
// the hierarchy that rays are traced in.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "baker/bake/group_keys.hpp"
#include "baker/bake/scene_bake.hpp"
#include "baker/effects/diffuse/direct.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

class GroupScene {
 public:
  // Places the samples of group `index` of the plan. All that is passed outlives this. Where the runtime
  // could not hold its glossy samples, they are Lambert's, and the report says so.
  GroupScene(const SceneBake& bake, const SurfaceInputs& inputs, std::size_t index,
             const BakeContext& context);
  GroupScene(const GroupScene&) = delete;  // what is loaded refers to the geometry
  GroupScene& operator=(const GroupScene&) = delete;

  const SceneBake& bake;
  const std::size_t index;  // in the plan
  const RigidGroup& group;
  GroupGeometry geometry;
  SampleSet samples;
  std::vector<PlannedLight> lights;
  GroupKeys keys;  // not set without a cache

  bool anyDiffuse() const { return samples.glossy.begin > 0; }
  bool anyGlossy() const { return !samples.glossy.empty(); }

  // Loads the colours, once: pictures take long to decode. Errors: images that cannot be decoded.
  Result<void> loadColors();
  // Loads the colours and BRDFs, and builds the hierarchy. Errors: as loadColors(), no memory for it.
  Result<void> prepareRays(const BakeContext& context);

  // After loadColors().
  const SurfaceColors& colors() const { return *colors_; }
  // After prepareRays(): what rays see, and how glossy surfaces reflect; null where there are none.
  TracedScene view() const { return {bake.scene, geometry, samples, *rays_, *colors_, lights}; }
  const SurfaceBrdfs* brdfs() const { return brdfs_ ? &*brdfs_ : nullptr; }

 private:
  SurfaceInputs inputs_;
  std::optional<SurfaceColors> colors_;
  std::optional<SurfaceBrdfs> brdfs_;
  std::optional<RayScene> rays_;
};

// Returns how many glossy samples a group may have: what the runtime holds of them lies in one page.
std::size_t mostGlossySamples(int glossy_order);

}  // namespace lambent::baker
