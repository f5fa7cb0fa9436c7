// Holds what the effects on one rigid group of surfaces share: its geometry, samples, lights and cache keys;
// and, once something has to be computed, its colours, its BRDFs and the ray hierarchy.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "baker/bake/bake.hpp"
#include "baker/bake/options.hpp"
#include "baker/bake/ship_meshes.hpp"
#include "baker/brdf/surface_brdfs.hpp"
#include "baker/cache/key.hpp"
#include "baker/effects/surface/direct.hpp"
#include "baker/import/image.hpp"
#include "baker/import/scene.hpp"
#include "baker/importance/importance.hpp"
#include "baker/jobs/bake_context.hpp"
#include "baker/plan/group_lights.hpp"
#include "baker/plan/local_light.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/surface_colors.hpp"

namespace lambent::baker {

// Makes the keys under which the results of a group are kept. Each key covers only what its result depends
// on: the keys of rays leave out colours, and no key has the strengths of lamps, names, or where a movable
// group stands.

struct GroupKeys {
  Key light_probes;
  Key rays;         // of pass 0: direct transfer and the hits of its rays
  Key glossy_rays;  // the same for glossy samples
  Key proxy;
  Key bounces;  // covers also what surfaces reflect
  Key cells;    // covers also how transfer is coded; the result is all that a group hands to the bundle
};

// PlannedGroup is the part of the plan, for one group, on which its results depend.
struct PlannedGroup {
  LightProbeCount light_probes{};
  bool shadows = true, bounces = true;
  std::span<const Eye> cameras{};
};

GroupKeys groupKeys(const Scene& scene, const GroupGeometry& geometry, std::span<const PlannedLight> lights,
                    const PlannedGroup& planned, const BakeOptions& options);

// Returns the key of the tables of b(v) of a scene's glossy materials.
Key brdfTablesKey(const Scene& scene, int order, int shipped);

// A SceneBake is the bake of one scene: what is asked for, and what is planned.
struct SceneBake {
  const Scene& scene;
  const BakeOptions& options;
  const EffectPlan& plan;
  const BrdfTables& tables;  // of the scene's glossy materials; empty if all are shown as diffuse

  tl::unexpected<Error> stopped() const {
    return fail(scene.source.string(), "stopped; nothing was written");
  }
};

// SurfaceInputs are the decoded meshes and images that surfaces are made of.
struct SurfaceInputs {
  const ShippedMeshes& meshes;
  DecodedImages& images;
};

class GroupScene {
 public:
  // Places the samples of group `index` of the plan. All arguments must outlive this. If the runtime could
  // not hold the group's glossy samples, they become diffuse, and a notice says so.
  GroupScene(const SceneBake& bake, const SurfaceInputs& inputs, std::size_t index,
             const BakeContext& context);
  GroupScene(const GroupScene&) = delete;  // the loaded parts refer to the geometry
  GroupScene& operator=(const GroupScene&) = delete;

  const SceneBake& bake;
  const std::size_t index;  // in the plan
  const RigidGroup& group;
  GroupGeometry geometry;
  SampleSet samples;
  std::vector<PlannedLight> lights;
  GroupKeys keys;                    // not set without a cache
  std::vector<std::string> notices;  // about results that differ from the plan

  const PlannedTransport& transport() const { return bake.plan.transport[index]; }
  // Returns whether light that bounces between surfaces is baked.
  bool bounces() const { return bake.options.bounces != 0 && transport().bounces; }
  bool anyDiffuse() const { return samples.glossy.begin > 0; }
  bool anyGlossy() const { return !samples.glossy.empty(); }

  // Loads the colours once, since images take long to decode. Errors: images that cannot be decoded.
  Result<void> loadColors();
  // Builds the ray hierarchy, once, and finds out what eyes see. Errors: images of cut-outs that cannot be
  // decoded, no memory for the hierarchy.
  Result<void> findImportance(const BakeContext& context);
  // Does both, and loads the BRDFs. Errors: those of both.
  Result<void> prepareRays(const BakeContext& context);

  // May be called after loadColors().
  const SurfaceColors& colors() const { return *colors_; }
  // May be called after prepareRays(). brdfs() returns null if the group has no glossy surfaces.
  TracedScene view() const {
    return {bake.scene,
            geometry,
            samples,
            *rays_,
            *colors_,
            lights,
            mirrors_ ? &*mirrors_ : nullptr,
            transport().shadows,
            &sample_importance_};
  }
  // May be called after findImportance().
  const Importance& importance() const { return importance_; }
  const SurfaceBrdfs* brdfs() const { return anyGlossy() && brdfs_ ? &*brdfs_ : nullptr; }

 private:
  SurfaceInputs inputs_;
  std::vector<Eye> cameras_;
  std::optional<SurfaceColors> colors_;
  std::optional<SurfaceBrdfs> brdfs_;
  std::optional<RayScene> rays_;
  Importance importance_;
  SampleImportance sample_importance_;
  std::optional<MirrorPaths> mirrors_;  // set with the BRDFs
};

// Returns how many glossy samples a group may have; the runtime holds what it shades of them in one page.
std::size_t mostGlossySamples(int glossy_order);

}  // namespace lambent::baker
