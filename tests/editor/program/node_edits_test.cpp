#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "editor/document/history.hpp"
#include "editor/session/scene_changes.hpp"
#include "tests/editor/document/small_world.hpp"

namespace lambent::editor {
namespace {

glm::mat4 placedAt(float x, float y, float z) {
  return glm::translate(glm::mat4(1.0f), glm::vec3(x, y, z));
}

class NodeEdits : public ::testing::Test {
 protected:
  baker::SceneEdits edits() const {
    baker::SceneEdits found;
    addNodeEdits(world.registry, world.description, world.instance, found);
    return found;
  }
  // Returns the node's matrix in the edited scene.
  glm::mat4 baked(const baker::SceneEdits& with, std::string_view name) const {
    std::vector<gltf::Node> nodes = world.description.nodes;
    for (const auto& edit : with.nodes) nodes[edit.index].parent_from_node = edit.parent_from_node;
    const std::vector<glm::mat4> matrices = gltf::worldTransforms(nodes);
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (nodes[i].name == name) return matrices[i];
    return {};
  }

  testing::SmallWorld world;
  Document document{world.registry, 1};
  History history{document};
};

TEST_F(NodeEdits, ANodeThatIsHungElsewhereIsBakedWhereItStands) {
  EXPECT_TRUE(edits().empty());
  const ecs::Entity lamp = world.node("lamp"), table = world.node("table"), camera = world.node("camera");
  const glm::mat4 before = worldFromNode(world.registry, lamp);
  ASSERT_TRUE(history.reparent(lamp, camera, /*keep_place=*/true));
  EXPECT_TRUE(edits().empty()) << "it stands where it stood";
  // It follows its new parent, and not the old one.
  ASSERT_TRUE(history.setField(camera, "Transform", "translation", glm::vec3(3.0f, 1.0f, 5.0f)));
  ASSERT_TRUE(history.setField(table, "Transform", "translation", glm::vec3(0.0f, 0.0f, 7.0f)));
  const glm::mat4 now = worldFromNode(world.registry, lamp);
  EXPECT_TRUE(samePlace(now, placedAt(3.0f, 0.0f, 0.0f) * before));
  EXPECT_TRUE(samePlace(baked(edits(), "lamp"), now));
  EXPECT_TRUE(samePlace(baked(edits(), "table"), worldFromNode(world.registry, table)));
  history.undo(), history.undo(), history.undo();
  EXPECT_TRUE(edits().empty());
}

TEST(SamePlace, ForgivesRoundingButNoMove) {
  const glm::mat4 far = placedAt(1000.0f, 0.0f, -3.0f), small = glm::scale(glm::mat4(1.0f), glm::vec3(1e-3f));
  EXPECT_TRUE(samePlace(placedAt(1000.003f, 0.0f, -3.0f), far));
  EXPECT_FALSE(samePlace(placedAt(1000.02f, 0.0f, -3.0f), far));
  EXPECT_FALSE(samePlace(placedAt(0.0f, 2e-5f, 0.0f), placedAt(0.0f, 0.0f, 0.0f)));
  // A thousandth of the size of a small thing counts as a change.
  EXPECT_FALSE(samePlace(glm::scale(small, glm::vec3(1.001f)), small));
  EXPECT_TRUE(samePlace(glm::scale(small, glm::vec3(1.000001f)), small));
}

}  // namespace
}  // namespace lambent::editor
