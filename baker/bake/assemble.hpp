// Puts a bundle together from what the bake found: views in the order in which a runtime wants them (meshes
// and rows, images, then per cell codebook and cluster ids, light weights and proxies, then weight planes by
// falling variance over all cells).
#pragma once

#include <vector>

#include "baker/bake/bake.hpp"
#include "baker/bake/bake_group.hpp"
#include "baker/bake/ship_meshes.hpp"
#include "baker/brdf/surface_brdfs.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/bundle/writer.hpp"

namespace lambent::baker {

struct AssembledBundle {
  bundle::Description description;
  std::vector<bundle::Blob> blobs;
};

// `baked` has one entry per plan group. tables: of the glossy materials; empty where they are shown as
// Lambert. Adds the sizes by kind to the report.
AssembledBundle assemble(const Scene& scene, const BakeOptions& options, const EffectPlan& plan,
                         const BrdfTables& tables, ShippedMeshes meshes, std::vector<BakedGroup> baked,
                         BakeReport& report);

}  // namespace lambent::baker
