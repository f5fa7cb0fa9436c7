// Refuses scenes with sizes that single precision cannot trace.
#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "baker/import/convert.hpp"
#include "baker/import/placed_box.hpp"

namespace lambent::baker {

namespace {

// Areas are products of two lengths and their squares of four, which must neither underflow nor overflow.
// Both limits leave a factor of ten to where tracing was seen to fail.
constexpr double kLeastSide_m = 1e-8, kMostDistance_m = 1e8;

}  // namespace

Result<void> checkSizes(const Document& document, const NodeMap& map, const Scene& scene) {
  std::vector<PlacedBox> boxes;
  for (const SceneMesh& mesh : scene.meshes) boxes.push_back(boxOf(mesh));
  const std::vector<glm::dmat4> world = sceneWorldTransforms(map, scene);
  // Of a node or one above it: places that cancel each other out have lost their digits.
  std::vector<double> farthest(world.size());
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    farthest[n] = largest(glm::dvec3(world[n][3]));
    if (const std::int32_t parent = scene.nodes[n].parent; parent >= 0)
      farthest[n] = std::max(farthest[n], farthest[static_cast<std::size_t>(parent)]);
    if (scene.nodes[n].mesh < 0) continue;
    const PlacedBox& box = boxes[static_cast<std::size_t>(scene.nodes[n].mesh)];
    if (box.empty()) continue;
    PlacedBox there;
    there.add(box, world[n]);
    const double distance = std::max({largest(there.low), largest(there.high), farthest[n]});
    if (!(distance <= kMostDistance_m))  // or not a number
      return fail(
          document.file(),
          fmt::format("node {} (\"{}\") reaches {:.3g} m from the origin, where floats cannot be traced", n,
                      scene.nodes[n].name, distance),
          fmt::format("scale or move it to within {:g} m", kMostDistance_m));
    if (there.side() > 0.0 && there.side() < kLeastSide_m)
      return fail(document.file(),
                  fmt::format("node {} (\"{}\") is only {:.3g} m large, which floats cannot trace", n,
                              scene.nodes[n].name, there.side()),
                  fmt::format("scale it to {:g} m or more, or to 0 to hide it", kLeastSide_m));
  }
  return {};
}

}  // namespace lambent::baker
