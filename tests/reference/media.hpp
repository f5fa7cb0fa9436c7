// Builds volumes for tests.
#pragma once

#include <functional>

#include <glm/gtc/matrix_transform.hpp>

#include "reference/volumes.hpp"
#include "tests/support/shapes.hpp"

namespace lambent::testing {

// Evaluates `density` at voxel centres, in voxels. The grid fills [0, size] of its node.
inline baker::SceneVolume medium(glm::uvec3 size, const std::function<float(glm::vec3)>& density) {
  baker::SceneVolume volume;
  volume.name = "medium";
  volume.size = size;
  for (std::uint32_t z = 0; z < size.z; ++z)
    for (std::uint32_t y = 0; y < size.y; ++y)
      for (std::uint32_t x = 0; x < size.x; ++x) volume.density.push_back(density(glm::vec3(x, y, z) + 0.5f));
  return volume;
}

inline void place(baker::Scene& scene, baker::SceneVolume volume,
                  const glm::mat4& parent_from_node = glm::mat4(1)) {
  volume.node = static_cast<std::uint32_t>(scene.nodes.size());
  addNode(scene, parent_from_node);
  scene.volumes.push_back(std::move(volume));
}

// Makes a box of uniform density.
inline baker::SceneVolume even(float density, glm::vec3 albedo = glm::vec3(1), float g = 0.0f,
                               glm::vec3 centre = glm::vec3(0), glm::vec3 size = glm::vec3(1)) {
  baker::SceneVolume volume = medium({3, 2, 4}, [&](glm::vec3) { return density; });
  volume.node_from_grid =
      glm::scale(glm::translate(glm::mat4(1), centre - 0.5f * size), size / glm::vec3(volume.size));
  volume.albedo = albedo;
  volume.g = g;
  return volume;
}

inline baker::reference::Volumes volumesOf(const baker::Scene& scene) {
  std::vector<std::string> notices;
  return baker::reference::Volumes::build(scene, notices);
}

// Returns the i-th of `count` directions spread evenly over the sphere (a Fibonacci lattice).
inline glm::dvec3 evenDirection(int i, int count) {
  const double y = 1.0 - (2.0 * i + 1.0) / count, r = std::sqrt(1.0 - y * y), turn = 2.39996322972865332 * i;
  return {r * std::cos(turn), y, r * std::sin(turn)};
}

}  // namespace lambent::testing
