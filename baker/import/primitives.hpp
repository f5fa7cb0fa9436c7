// Applies morph targets and skins on the CPU, once at import: a mesh stays as the file's own weights and
// joints pose it. A renderer would do this per frame (glTF 2.0, sections 3.7.2.2 and 3.7.3).
#pragma once

#include <string>
#include <vector>

#include <glm/mat4x4.hpp>

#include "baker/import/document.hpp"
#include "runtime/base/result.hpp"
#include "runtime/bundle/mesh.hpp"

namespace lambent_tinygltf {
struct Primitive;
}

namespace lambent::baker {

struct MeshPose {
  std::vector<float> weights;      // weights of the morph targets; missing ones are 0
  std::vector<glm::dmat4> joints;  // posed mesh from stored mesh, by joint; empty if there is no skin
};

// Holds four joints of each vertex and their weights; a vertex may have up to kMaxInfluences sets of them.
struct Influences {
  std::vector<glm::vec4> joints, weights;
};

// Adds weight times displacement of every target to positions, normals and tangents.
Result<void> applyMorphTargets(const Document& document, const lambent_tinygltf::Primitive& primitive,
                               const std::vector<float>& weights, const std::string& name,
                               bundle::MeshData& mesh);

// Moves every vertex by the weighted mean of its joints' matrices. Errors: the skin does not have such a
// joint.
Result<void> applySkin(const std::vector<Influences>& sets, const std::vector<glm::dmat4>& joints,
                       const std::string& file, const std::string& name, bundle::MeshData& mesh);

// Reads one primitive of a checked document as posed triangles, from plain or Draco data, and lists, strips
// or fans.

// Returns an empty mesh, and adds a warning, if it has no triangles. The mesh is not cleaned yet.
Result<bundle::MeshData> readPrimitive(const Document& document, const lambent_tinygltf::Primitive& primitive,
                                       const MeshPose& pose, bool tangents, const std::string& name,
                                       std::vector<std::string>& warnings);

}  // namespace lambent::baker
