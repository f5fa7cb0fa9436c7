#include "baker/import/pose.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "baker/import/accessor.hpp"
#include "baker/import/hints.hpp"
#include "baker/import/tinygltf.hpp"
#include "runtime/base/normal_matrix.hpp"

namespace lambent::baker {
namespace {

template <typename Vector>
Result<void> addDisplacements(const Document& document, int accessor, float weight, const char* semantic,
                              const std::string& name, std::vector<Vector>& values) {
  if (values.empty()) return {};
  const auto floats = readFloats(document, accessor, name + ": " + semantic, {3}, 3);
  if (!floats) return failAgain(floats.error());
  if (floats->count() != values.size())
    return fail(
        document.file(),
        fmt::format("{}: {} has {} elements, the mesh {}", name, semantic, floats->count(), values.size()),
        kExportAgain);
  for (std::size_t v = 0; v < values.size(); ++v)
    for (int c = 0; c < 3; ++c) values[v][c] += weight * floats->values[3 * v + static_cast<std::size_t>(c)];
  return {};
}

}  // namespace

Result<void> applyMorphTargets(const Document& document, const tinygltf::Primitive& primitive,
                               const std::vector<float>& weights, const std::string& name,
                               bundle::MeshData& mesh) {
  for (std::size_t t = 0; t < std::min(primitive.targets.size(), weights.size()); ++t) {
    if (weights[t] == 0.0f) continue;
    const std::string target = fmt::format("{}, morph target {}", name, t);
    for (const auto& [semantic, accessor] : primitive.targets[t]) {
      Result<void> done;
      if (semantic == "POSITION")
        done = addDisplacements(document, accessor, weights[t], "POSITION", target, mesh.positions);
      else if (semantic == "NORMAL")
        done = addDisplacements(document, accessor, weights[t], "NORMAL", target, mesh.normals);
      else if (semantic == "TANGENT")
        done = addDisplacements(document, accessor, weights[t], "TANGENT", target, mesh.tangents);
      if (!done) return done;
    }
  }
  return {};
}

Result<void> applySkin(const std::vector<Influences>& sets, const std::vector<glm::dmat4>& joints,
                       const std::string& file, const std::string& name, bundle::MeshData& mesh) {
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    glm::dmat4 matrix(0.0);
    double sum = 0.0;
    for (const Influences& set : sets)
      for (int c = 0; c < 4; ++c) {
        const float weight = set.weights[v][c], joint = set.joints[v][c];
        if (!std::isfinite(weight) || weight < 0.0f)
          return fail(file, fmt::format("{}: vertex {} has a joint weight of {}", name, v, weight),
                      kExportAgain);
        if (weight == 0.0f) continue;
        if (!(joint >= 0.0f && joint < static_cast<float>(joints.size())))
          return fail(file,
                      fmt::format("{}: vertex {} hangs on joint {} of {}", name, v, joint, joints.size()),
                      kExportAgain);
        matrix += static_cast<double>(weight) * joints[static_cast<std::size_t>(joint)];
        sum += static_cast<double>(weight);
      }
    if (sum == 0.0) continue;  // belongs to no joint and stays in place
    matrix /= sum;             // quantized weights do not sum to exactly 1
    mesh.positions[v] = glm::vec3(matrix * glm::dvec4(mesh.positions[v], 1.0));
    const glm::dmat3 linear(matrix);
    // Normals without direction are left for cleaning, which reports them.
    if (!mesh.normals.empty()) {
      const glm::dvec3 normal = normalMatrix(linear) * glm::dvec3(mesh.normals[v]);
      const double length = glm::length(normal);
      mesh.normals[v] = glm::vec3(length > 0.0 ? normal / length : normal);
    }
    if (!mesh.tangents.empty())
      mesh.tangents[v] = glm::vec4(glm::vec3(linear * glm::dvec3(mesh.tangents[v])), mesh.tangents[v].w);
  }
  return {};
}

}  // namespace lambent::baker
