#include "editor/session/node_edits.hpp"

#include <glm/matrix.hpp>

#include "editor/document/document.hpp"
#include "editor/session/same_place.hpp"
#include "runtime/base/finite.hpp"
#include "runtime/scene/affine.hpp"
#include "runtime/scene/components.hpp"

namespace lambent::editor {

void addNodeEdits(const ecs::Registry& registry, const bundle::Description& description,
                  const scene::SceneInstance& instance, baker::SceneEdits& edits) {
  for (std::uint32_t i = 0; i < description.nodes.size(); ++i) {
    const gltf::Node& node = description.nodes[i];
    const auto* transform = registry.tryGet<scene::Transform>(instance.nodes[i]);
    if (!transform || node.animated) continue;
    const ecs::Entity parent =
        node.parent < 0 ? instance.root : instance.nodes[static_cast<std::size_t>(node.parent)];
    glm::mat4 now = scene::localMatrix(*transform);
    if (transform->parent != parent)
      now = glm::mat4(glm::inverse(glm::dmat4(worldFromNode(registry, parent))) *
                      glm::dmat4(worldFromNode(registry, instance.nodes[i])));
    // Below a flat parent no Transform gives it that place; it stays where the scene has it.
    if (isFinite(now) && !samePlace(now, node.parent_from_node)) edits.nodes.push_back({i, node.name, now});
  }
}

}  // namespace lambent::editor
