// A SceneVolume is a medium that absorbs and scatters light: a grid of densities at a node, read from the
// file that extras.lambent.volume names (docs/authoring.md). Density is given at voxel centres, is linear
// between them and constant in the half voxel towards the faces of the box, and is 0 outside. The bake, the
// reference and the runtime all read it this way.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace lambent::baker {

struct SceneVolume {
  std::string name;        // "cloud.vdb: density"
  std::uint32_t node = 0;  // node that it hangs on
  glm::uvec3 size{0};      // voxels
  // This is extinction in m^-1 of the world, whatever the node's scale: the file's values times
  // density_scale. Values are finite and not negative; x runs fastest, then y, then z.
  std::vector<float> density;
  // The matrix is affine, from voxel coordinates, in which voxel (i, j, k) fills [i, i + 1] x ...
  glm::mat4 node_from_grid{1.0f};
  glm::vec3 albedo{1.0f};  // share of the extinction that scatters, 0..1
  float g = 0.0f;          // Henyey-Greenstein: mean cosine, -1 < g < 1

  std::size_t index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return x + std::size_t{size.x} * (y + std::size_t{size.y} * z);
  }
};

}  // namespace lambent::baker
