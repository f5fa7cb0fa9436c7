#include "editor/session/moved_parts.hpp"

#include <cmath>
#include <set>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "runtime/scene/components.hpp"

namespace lambent::editor {

namespace {

constexpr float kRounding = 1e-4f;  // of the largest number of the matrix

bool differs(const glm::mat4& a, const glm::mat4& b) {
  float largest = 1.0f;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) largest = std::max(largest, std::abs(b[column][row]));
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (std::abs(a[column][row] - b[column][row]) > kRounding * largest) return true;
  return false;
}

}  // namespace

void addMovedParts(const ecs::Registry& registry, const bundle::Description& description,
                   const scene::SceneInstance& instance, std::vector<std::string>& sentences) {
  const std::vector<glm::mat4> rest = gltf::worldTransforms(description.nodes);
  std::set<std::uint32_t> told;
  for (const bundle::Draw& draw : description.draws) {
    const auto* group = registry.tryGet<scene::RigidGroupComponent>(instance.groups[draw.group]);
    const auto* node = registry.tryGet<scene::WorldTransform>(instance.nodes[draw.node]);
    if (!group || !node || !differs(node->world_from_node, group->world_from_rest * rest[draw.node]))
      continue;
    if (!told.insert(draw.node).second) continue;
    sentences.push_back(
        fmt::format("{}: moved within its rigid group, whose shadows and bounces still have it in "
                    "its old place",
                    description.nodes[draw.node].name));
  }
}

}  // namespace lambent::editor
