// Morph targets and skins, applied on the CPU: a mesh stands as the file's own weights and joints put it, and
// stays so. What a renderer does per frame (glTF 2.0, sections 3.7.2.2 and 3.7.3), done once at import.
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
  std::vector<float> weights;      // of the morph targets; missing ones are 0
  std::vector<glm::dmat4> joints;  // mesh at rest from mesh as stored, by joint; empty: no skin
};

// Four joints of each vertex and their weights; up to kMaxInfluences sets of them.
struct Influences {
  std::vector<glm::vec4> joints, weights;
};

// Adds weight times displacement of every target to positions, normals and tangents.
Result<void> applyMorphTargets(const Document& document, const lambent_tinygltf::Primitive& primitive,
                               const std::vector<float>& weights, const std::string& name,
                               bundle::MeshData& mesh);

// Moves every vertex by the weighted mean of its joints' matrices. Errors: joints that the skin does not
// have.
Result<void> applySkin(const std::vector<Influences>& sets, const std::vector<glm::dmat4>& joints,
                       const std::string& file, const std::string& name, bundle::MeshData& mesh);

}  // namespace lambent::baker
