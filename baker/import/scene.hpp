// The scene as the baker sees it: any glTF file brought to triangles with normals, in mesh space, linear
// colours. Images stay encoded (they travel to the bundle as they are); decodeImage() gives texels where a
// pass needs them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "baker/import/measured_brdf.hpp"
#include "baker/import/volume.hpp"
#include "runtime/base/result.hpp"
#include "runtime/bundle/gltf_types.hpp"
#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

struct ScenePrimitive {
  bundle::MeshData mesh;  // triangles; normals always present (made flat where the file has none)
  std::int32_t material = -1;
};

struct SceneMesh {
  std::string name;
  std::vector<ScenePrimitive> primitives;
};

struct SceneImage {
  std::string name;
  std::string mime_type;              // image/png or image/jpeg
  std::vector<std::byte> file_bytes;  // as it stands in the source
};

// extras.lambent.neighborhood of a node that starts a rigid group: asks for neighborhood transfer.
struct NeighborhoodRequest {
  std::uint32_t node = 0;
  glm::uvec3 size{0};      // points; 0: as the bake sees fit
  glm::vec3 extent{0.0f};  // of the grid, m, about the centre of the group's bounds; 0: as the bake sees fit
};

struct Scene {
  std::filesystem::path source;
  std::vector<gltf::Node> nodes;
  std::vector<std::int32_t> roots;  // of the default scene
  std::vector<SceneMesh> meshes;
  std::vector<gltf::Material> materials;
  std::vector<MeasuredBrdf> brdfs;  // that Material::brdf counts in
  std::vector<gltf::Texture> textures;
  std::vector<SceneImage> images;
  std::vector<gltf::Camera> cameras;
  std::vector<gltf::Light> lights;
  std::vector<gltf::Animation> animations;
  std::vector<SceneVolume> volumes;                // at most one at a node
  std::vector<NeighborhoodRequest> neighborhoods;  // at most one for a node
  std::vector<std::string> warnings;               // what was left out, one sentence each
};

}  // namespace lambent::baker
