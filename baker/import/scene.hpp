// A SceneVolume is a medium that absorbs and scatters light: a grid of densities at a node, read from the
// file that extras.lambent.volume names (docs/authoring.md). Density is given at voxel centres, is linear
// between them and constant in the half voxel towards the faces of the box, and is 0 outside. The bake, the
// reference and the runtime all read it this way.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "baker/import/measured_brdf.hpp"
#include "runtime/base/result.hpp"
#include "runtime/bundle/gltf_types.hpp"
#include "runtime/bundle/mesh.hpp"

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

// A Scene is any glTF file as the baker sees it: as triangles with normals, in mesh space, with linear
// colours. Images stay encoded, since they go into the bundle as they are; decodeImage() gives texels to
// passes that need them.

struct ScenePrimitive {
  bundle::MeshData mesh;  // triangles; normals are always present (flat if the file has none)
  std::int32_t material = -1;
  // The author asks for transfer at a square of so many texels along a side, by this set of texture
  // coordinates, in which no two points share a place; 0: transfer at vertices (texture_transfer.hpp).
  std::uint32_t texels = 0, texel_set = 0;
};

struct SceneMesh {
  std::string name;
  std::vector<ScenePrimitive> primitives;
};

struct SceneImage {
  std::string name;
  std::string mime_type;              // image/png or image/jpeg
  std::vector<std::byte> file_bytes;  // as in the source
};

// A NeighborhoodRequest asks for neighborhood transfer; it is the extras.lambent.neighborhood of a node that
// starts a rigid group.
struct NeighborhoodRequest {
  std::uint32_t node = 0;
  glm::uvec3 size{0};  // points; 0 leaves the choice to the bake
  // The size of the grid is in m, about the centre of the group's bounds; 0 leaves the choice to the bake.
  glm::vec3 extent{0.0f};
};

struct Scene {
  std::filesystem::path source;
  // Nodes stand relative to this point of the file's world, in m, so that floats are fine enough. Unless it
  // is 0 there is one root, which stands there and never moves.
  glm::dvec3 origin{0.0};
  std::vector<gltf::Node> nodes;
  std::vector<std::int32_t> roots;  // roots of the default scene
  std::vector<SceneMesh> meshes;
  std::vector<gltf::Material> materials;
  std::vector<MeasuredBrdf> brdfs;  // Material::brdf is an index into these
  std::vector<gltf::Texture> textures;
  std::vector<SceneImage> images;
  std::vector<gltf::Camera> cameras;
  std::vector<gltf::Light> lights;
  std::vector<gltf::Animation> animations;
  std::vector<SceneVolume> volumes;                // at most one per node
  std::vector<NeighborhoodRequest> neighborhoods;  // at most one per node
  std::vector<std::string> warnings;               // what was left out, one sentence each
};

}  // namespace lambent::baker
