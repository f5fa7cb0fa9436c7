// Refuses scenes with sizes that single precision cannot trace.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "baker/import/convert.hpp"

namespace lambent::baker {

namespace {

// Areas are products of two lengths and their squares of four, which must neither underflow nor overflow.
// Both limits leave a factor of ten to where tracing was seen to fail.
constexpr double kLeastSide_m = 1e-8, kMostDistance_m = 1e8;

struct Box {
  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
  void add(const glm::dvec3& point) {
    low = glm::min(low, point);
    high = glm::max(high, point);
  }
};

Box boxOf(const SceneMesh& mesh) {
  Box box;
  for (const ScenePrimitive& primitive : mesh.primitives)
    for (const glm::vec3& position : primitive.mesh.positions) box.add(glm::dvec3(position));
  return box;
}

Box placed(const Box& box, const glm::dmat4& world_from_mesh) {
  Box out;
  for (int corner = 0; corner < 8; ++corner)
    out.add(glm::dvec3(world_from_mesh * glm::dvec4((corner & 1) ? box.high.x : box.low.x,
                                                    (corner & 2) ? box.high.y : box.low.y,
                                                    (corner & 4) ? box.high.z : box.low.z, 1.0)));
  return out;
}

double largest(const glm::dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace

Result<void> checkSizes(const Document& document, const Scene& scene) {
  std::vector<Box> boxes;
  for (const SceneMesh& mesh : scene.meshes) boxes.push_back(boxOf(mesh));
  const std::vector<glm::mat4> world = gltf::worldTransforms(scene.nodes);
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    if (scene.nodes[n].mesh < 0) continue;
    const Box& box = boxes[static_cast<std::size_t>(scene.nodes[n].mesh)];
    if (box.low.x > box.high.x) continue;  // no vertices
    const Box there = placed(box, glm::dmat4(world[n]));
    const double distance = std::max(largest(there.low), largest(there.high)),
                 side = largest(there.high - there.low);
    if (!(distance <= kMostDistance_m))  // or not a number
      return fail(
          document.file(),
          fmt::format("node {} (\"{}\") reaches {:.3g} m from the origin, where floats cannot be traced", n,
                      scene.nodes[n].name, distance),
          fmt::format("scale or move it to within {:g} m", kMostDistance_m));
    if (side > 0.0 && side < kLeastSide_m)
      return fail(document.file(),
                  fmt::format("node {} (\"{}\") is only {:.3g} m large, which floats cannot trace", n,
                              scene.nodes[n].name, side),
                  fmt::format("scale it to {:g} m or more, or to 0 to hide it", kLeastSide_m));
  }
  return {};
}

}  // namespace lambent::baker
