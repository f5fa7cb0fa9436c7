// Holds what all groups of a scene share while they are baked.
#pragma once

#include "baker/bake/bake.hpp"
#include "baker/bake/ship_meshes.hpp"
#include "baker/brdf/surface_brdfs.hpp"
#include "baker/import/image.hpp"
#include "baker/transport/surface_colors.hpp"

namespace lambent::baker {

// A SceneBake is the bake of one scene: what is asked for, what is planned, and the report that all stages
// add to.
struct SceneBake {
  const Scene& scene;
  const BakeOptions& options;
  const EffectPlan& plan;
  const BrdfTables& tables;  // of the scene's glossy materials; empty if all are shown as diffuse
  BakeReport& report;

  tl::unexpected<Error> stopped() const {
    return fail(scene.source.string(), "stopped; nothing was written");
  }
};

// SurfaceInputs are the decoded meshes and images that surfaces are made of.
struct SurfaceInputs {
  const ShippedMeshes& meshes;
  const AlphaMaps& alpha_maps;
  DecodedImages& images;
};

}  // namespace lambent::baker
