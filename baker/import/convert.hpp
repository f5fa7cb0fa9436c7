// The conversions of the parts of a checked document, in the order in which importScene() calls them. Each
// takes the document and the scene so far; warnings go into scene.warnings, one sentence each, led by the
// object ("node 3: ...").
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>

#include "baker/import/document.hpp"
#include "baker/import/scene.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

// Materials, and the textures and images that they use. Numbered as in the file.
Result<void> convertMaterials(const Document& document, Scene& scene);

// Punctual lights, numbered as in the file.
void convertLights(const Document& document, Scene& scene);

// Which node of the file became which of the scene; -1: it stands in another scene, or (made here) in no
// file.
struct NodeMap {
  std::vector<std::int32_t> scene_node;  // by node of the file
  std::vector<std::int32_t> file_node;   // by node of the scene
};

// The nodes of the default scene, renumbered, with their cameras. Meshes keep the file's numbers for now.
Result<NodeMap> convertNodes(const Document& document, Scene& scene);
// The node's own transform, and its parts where it has any.
glm::mat4 localMatrix(const Document& document, std::size_t file_node);
// world_from_node of every node of the file, also of those that stand in no scene (joints may).
std::vector<glm::mat4> fileWorldTransforms(const Document& document);

// The meshes that nodes of the scene draw, as they stand at rest: a mesh with a skin, or with other weights
// of its morph targets, becomes a mesh of its own. Nodes get the scene's numbers.
Result<void> convertMeshes(const Document& document, NodeMap& map, Scene& scene);

// Channels that move nodes of the scene; these nodes become animated and get the parts of their transform.
Result<void> convertAnimations(const Document& document, const NodeMap& map, Scene& scene);

// EXT_mesh_gpu_instancing: a child node for every instance. Last, since it adds nodes.
Result<void> convertInstances(const Document& document, const NodeMap& map, Scene& scene);

// extras.lambent.volume and extras.lambent.neighborhood: Scene::volumes, Scene::neighborhoods.
Result<void> convertGrids(const Document& document, const NodeMap& map, Scene& scene);

// Non-finite and degenerate triangles out, flat normals where there are none (or none usable), normals and
// tangents of unit length, unused vertices out. `name` stands at the head of warnings.
void cleanMesh(bundle::MeshData& mesh, const std::string& name, std::vector<std::string>& warnings);

}  // namespace lambent::baker
