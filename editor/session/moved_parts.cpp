#include "editor/session/moved_parts.hpp"

#include <set>

#include <fmt/format.h>

#include "editor/session/same_place.hpp"
#include "runtime/scene/components.hpp"

namespace lambent::editor {

void addMovedParts(const ecs::Registry& registry, const bundle::Description& description,
                   const scene::SceneInstance& instance, std::vector<std::string>& sentences) {
  const std::vector<glm::mat4> rest = gltf::worldTransforms(description.nodes);
  std::set<std::uint32_t> told;
  for (const bundle::Draw& draw : description.draws) {
    const auto* group = registry.tryGet<scene::RigidGroupComponent>(instance.groups[draw.group]);
    const auto* node = registry.tryGet<scene::WorldTransform>(instance.nodes[draw.node]);
    if (!group || !node || samePlace(node->world_from_node, group->world_from_rest * rest[draw.node]))
      continue;
    if (!told.insert(draw.node).second) continue;
    sentences.push_back(
        fmt::format("{}: moved within its rigid group, whose shadows and bounces still have it in "
                    "its old place",
                    description.nodes[draw.node].name));
  }
}

}  // namespace lambent::editor
