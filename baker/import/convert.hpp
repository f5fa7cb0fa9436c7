// Converts the parts of a checked document, in the order in which importScene() calls these functions. Each
// takes the document and the scene so far. Warnings go into scene.warnings, one sentence each, beginning with
// the object ("node 3: ...").
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>

#include "baker/import/document.hpp"
#include "baker/import/scene.hpp"

namespace lambent::baker {

// Converts materials, and the textures and images that they use. Materials are numbered as in the file.
void convertMaterials(const Document& document, Scene& scene);

// Converts punctual lights, numbered as in the file.
void convertLights(const Document& document, Scene& scene);

// Maps nodes of the file to those of the scene and back. -1 marks nodes of other scenes in the file, and
// nodes made here. Parents precede their children in the scene until placeNearOrigin().
struct NodeMap {
  std::vector<std::int32_t> scene_node;  // by node of the file
  std::vector<std::int32_t> file_node;   // by node of the scene
  // Indexed by node of the scene. They are in double as in the file; the scene has rounded ones.
  std::vector<glm::dmat4> parent_from_node;
};

// Converts the nodes of the default scene, renumbered, and their cameras. Meshes keep the file's numbers for
// now.
NodeMap convertNodes(const Document& document, Scene& scene);
// Holds translation, rotation and scale of a node that has no matrix. The rotation is unit.
struct NodeParts {
  glm::dvec3 translation{0.0}, scale{1.0};
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
};
NodeParts partsOf(const nlohmann::json& node);
// Returns the node's own transform, from its matrix or its parts.
glm::dmat4 localMatrix(const nlohmann::json& node);
// Returns world_from_node of every node of the file, including nodes outside all scenes (joints may be).
std::vector<glm::dmat4> fileWorldTransforms(const Document& document);
// Returns world_from_node of every node of the scene, with the file's origin.
std::vector<glm::dmat4> sceneWorldTransforms(const NodeMap& map, const Scene& scene);

// Says how a mesh stays posed: by the file's own weights of morph targets and joints, which a renderer would
// apply per frame (glTF 2.0, sections 3.7.2.2 and 3.7.3).
struct MeshPose {
  std::vector<float> weights;      // weights of the morph targets; missing ones are 0
  std::vector<glm::dmat4> joints;  // posed mesh from stored mesh, by joint; empty if there is no skin
};
// Reads one primitive of a checked document as posed triangles, from plain or Draco data, and lists, strips
// or fans. Returns an empty mesh, and adds a warning, if it has no triangles. The mesh is not cleaned yet.
bundle::MeshData readPrimitive(const Document& document, const nlohmann::json& primitive,
                               const MeshPose& pose, bool tangents, const std::string& name,
                               std::vector<std::string>& warnings);

// Converts the meshes that nodes of the scene draw, at rest. A mesh with a skin, or with other weights of its
// morph targets, becomes a mesh of its own. Nodes get the scene's mesh numbers.
void convertMeshes(const Document& document, NodeMap& map, Scene& scene);

// Converts channels that move nodes of the scene; these nodes become animated and get separate transform
// parts.
void convertAnimations(const Document& document, const NodeMap& map, Scene& scene);

// Makes a child node for every instance of EXT_mesh_gpu_instancing. This follows the other conversions of
// nodes, since it adds some.
void convertInstances(const Document& document, NodeMap& map, Scene& scene);

// Converts extras.lambent.volume and extras.lambent.neighborhood to Scene::volumes and Scene::neighborhoods.
void convertGrids(const Document& document, const NodeMap& map, Scene& scene);

// Subtracts Scene::origin from the places of all nodes, in double, and rounds them only then. The origin is 0
// where the scene stands near that of the file. Refuses bodies of a size, or at a place, that cannot be
// traced.
void placeNearOrigin(NodeMap map, Scene& scene);

// Warns about a body around all others that keeps light from outside away, such as a sky dome.
void warnAboutDomes(Scene& scene);

// Removes non-finite and degenerate triangles and unused vertices, makes flat normals where there are no
// usable ones, and makes normals and tangents unit. Warnings begin with `name`.
void cleanMesh(bundle::MeshData& mesh, const std::string& name, std::vector<std::string>& warnings);

}  // namespace lambent::baker
