// A medium that absorbs and scatters, as the scene brings it: a grid of densities at a node, read from the
// file that extras.lambent.volume names (docs/authoring.md). Density stands at voxel centres, is linear
// between them, constant in the half voxel towards the faces of the box, and 0 outside. The bake, the
// reference and the runtime all read it so.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace lambent::baker {

struct SceneVolume {
  std::string name;            // "cloud.vdb: density"
  std::uint32_t node = 0;      // where it hangs
  glm::uvec3 size{0};          // voxels
  std::vector<float> density;  // extinction in m^-1 of the world, whatever the node's scale: the file's
                               // values times density_scale; finite, not negative; x fastest, then y, then z
  glm::mat4 node_from_grid{1.0f};  // affine; of voxel coordinates: voxel (i, j, k) fills [i, i + 1] x ...
  glm::vec3 albedo{1.0f};          // share of the extinction that scatters, 0..1
  float g = 0.0f;                  // Henyey-Greenstein: mean cosine, -1 < g < 1

  std::size_t index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return x + std::size_t{size.x} * (y + std::size_t{size.y} * z);
  }
};

}  // namespace lambent::baker
