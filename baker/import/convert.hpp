// The conversions of the parts of a checked document, in the order in which importScene() calls them. Each
// takes the document and the scene so far; warnings go into scene.warnings, one sentence each.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/mat3x3.hpp>

#include "baker/import/document.hpp"
#include "baker/import/scene.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

// What a primitive must know about its material beyond gltf::Material.
struct UvTransform {
  glm::mat3 matrix{1.0f};  // KHR_texture_transform of the base colour, applied to the coordinates themselves
  std::uint32_t texcoord = 0;  // the set that it applies to
  bool identity = true;
};

// Materials, and the textures and images that base colours use. One UvTransform per material.
Result<std::vector<UvTransform>> convertMaterials(const Document& document, Scene& scene);

// All meshes, numbered as in the file.
Result<void> convertMeshes(const Document& document, const std::vector<UvTransform>& transforms,
                           Scene& scene);

// The nodes of the default scene, renumbered, with their cameras.
Result<void> convertNodes(const Document& document, Scene& scene);

// Non-finite and degenerate triangles out, flat normals where there are none (or none usable), normals of
// unit length, unused vertices out. `name` stands at the head of warnings.
void cleanMesh(bundle::MeshData& mesh, const std::string& name, std::vector<std::string>& warnings);

}  // namespace lambent::baker
