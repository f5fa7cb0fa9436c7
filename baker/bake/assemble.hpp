// Puts a bundle together from what the bake found. Its views lie in the order in which a runtime wants them:
// meshes and rows, images, then the codebook and cluster ids of each cell, BRDF tables, light weights and
// proxies, then the weight planes of all cells by falling variance.
#pragma once

#include <vector>

#include "baker/bake/bake_group.hpp"
#include "baker/bake/group_scene.hpp"
#include "runtime/bundle/container.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {

struct AssembledBundle {
  bundle::Description description;
  std::vector<bundle::Blob> blobs;
  BakeReport report;  // sizes by kind
};

// `baked` has one entry per plan group.
AssembledBundle assemble(const SceneBake& bake, ShippedMeshes meshes, const std::vector<BakedGroup>& baked);

}  // namespace lambent::baker
