#include "editor/document/actions.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "editor/document/tree.hpp"
#include "runtime/scene/components.hpp"
#include "small_world.hpp"

namespace lambent::editor {
namespace {

class Actions : public ::testing::Test {
 protected:
  const scene::LocalLightComponent& light(ecs::Entity entity) const {
    return world.registry.get<scene::LocalLightComponent>(entity);
  }
  ecs::Entity make(const char* kind, const char* name, ecs::Entity parent = {}) {
    EntitySnapshot snapshot = lightEntity(kind, name);
    if (parent) snapshot.parent = document.adopt(parent);
    return *history.create(snapshot);
  }
  std::string nameOf(ecs::Entity entity) const { return document.nameOf(entity); }

  testing::SmallWorld world;
  Document document{world.registry, 1};
  History history{document};
};

TEST_F(Actions, SelectionBoxesTurnWithWhatTheyEnclose) {
  const ecs::Entity table = world.node("table");
  Selection selection;
  selection.set(document.adopt(table));
  const glm::quat turned = glm::angleAxis(0.7f, glm::vec3(0.0f, 1.0f, 0.0f));
  ASSERT_TRUE(history.setField(table, "Transform", "rotation", turned));
  const std::vector<TurnedBox> boxes = selectionBoxes(document, selection);
  ASSERT_EQ(boxes.size(), 1u);
  const glm::vec3 size = boxes[0].box.max - boxes[0].box.min;
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(size[axis], 2.0f, 1e-5f) << "1 m, scaled by 2";
  const glm::vec3 x(boxes[0].world_from_box[0]);
  EXPECT_NEAR(glm::length(x - turned * glm::vec3(1.0f, 0.0f, 0.0f)), 0.0f, 1e-5f);
}

TEST_F(Actions, EntitiesAreCopiedWithWhatHangsBelow) {
  const ecs::Entity stand = make("point", "stand", world.node("table"));
  make("spot", "bulb", stand);
  const std::vector<EntitySnapshot> copies = *copyEntities(document, {&stand, 1});
  ASSERT_TRUE(history.destroy({&stand, 1}));
  const auto made = pasteEntities(document, history, copies);
  ASSERT_TRUE(made) << made.error().line();
  ASSERT_EQ(made->size(), 1u);
  EXPECT_EQ(nameOf((*made)[0]), "stand");
  EXPECT_FALSE(parentOf(world.registry, (*made)[0])) << "at the top of the world";
  EXPECT_EQ(withDescendants(world.registry, *made).size(), 2u);
  history.undo();
  EXPECT_EQ(world.registry.count<Created>(), 0u);
}

TEST_F(Actions, DuplicatesStandBesideTheirOriginalsUnderNewNames) {
  const ecs::Entity bulb = make("sphere", "bulb", world.node("table"));
  make("point", "spark", bulb);
  const ecs::Entity both[] = {bulb, world.node("lamp")};
  const auto made = duplicate(document, history, both);
  ASSERT_TRUE(made) << made.error().line();
  ASSERT_EQ(made->size(), 2u);
  EXPECT_EQ(nameOf((*made)[0]), "bulb 2");
  EXPECT_EQ(nameOf((*made)[1]), "lamp 2");
  EXPECT_EQ(light((*made)[1]).strength, 7.0f) << "a light of the bundle, now one of our own";
  EXPECT_EQ(parentOf(world.registry, (*made)[0]), world.node("table"));
  EXPECT_EQ(withDescendants(world.registry, {(*made)[0]}).size(), 2u);
  history.undo();
  EXPECT_EQ(world.registry.count<Created>(), 2u);
  const ecs::Entity table = world.node("table");
  EXPECT_NE(duplicate(document, history, {&table, 1}).error().line().find("shows a mesh"), std::string::npos);
}

TEST_F(Actions, ResetGoesBackToTheBundleOrToTheDefault) {
  const BaselineBundle bundle{&world.description, "small.lmb.glb", 0};
  const Baseline baseline = std::move(*Baseline::create({&bundle, 1}));
  const ecs::Entity both[] = {world.node("lamp"), make("point", "bulb")};
  for (const ecs::Entity entity : both) ASSERT_TRUE(history.setField(entity, "Light", "strength", 99.0f));
  ASSERT_TRUE(history.setField(both[0], "Light", "enabled", false));
  const scene::FieldInfo& strength = **scene::findField("Light", "strength");
  EXPECT_FALSE(isDefault(document, baseline, both[0], strength));
  ASSERT_TRUE(resetToDefault(document, history, baseline, both, "Light", "strength"));
  EXPECT_EQ(light(both[0]).strength, 7.0f);
  EXPECT_EQ(light(both[1]).strength, 1.0f);
  EXPECT_FALSE(light(both[0]).enabled) << "only the one field";
  EXPECT_TRUE(isDefault(document, baseline, both[0], strength));
  ASSERT_TRUE(resetToDefault(document, history, baseline, both, "Light"));
  EXPECT_TRUE(light(both[0]).enabled);
}

// ---- selection

TEST_F(Actions, TheSelectionSurvivesAReloadAndRangesFollowTheRows) {
  std::vector<StableId> rows;
  for (const ecs::Entity node : world.instance.nodes) rows.push_back(document.idOf(node));
  Selection selection;
  selection.set(rows[1]);
  selection.range(rows, rows[3]);
  EXPECT_EQ(selection.ids().size(), 3u);
  EXPECT_EQ(selection.primary(), rows[3]);
  selection.range(rows, rows[0]);
  EXPECT_EQ(selection.ids().size(), 2u) << "from the same anchor, upwards";
  selection.toggle(rows[1]);
  EXPECT_FALSE(selection.contains(rows[1]));
  selection.set(rows);
  EXPECT_EQ(selection.topmost(document).size(), 2u) << "table and camera: the others hang below";
  scene::destroyInstance(world.registry, world.instance);
  EXPECT_TRUE(selection.entities(document).empty());
  world.add(0);
  EXPECT_EQ(selection.entities(document).size(), 4u);
  EXPECT_EQ(selection.primaryEntity(document), world.node("camera"));
}

// ---- tree

std::string drawn(const std::vector<TreeRow>& rows) {
  std::string text;
  for (const TreeRow& row : rows)
    text +=
        std::string(row.depth, '.') + row.name + ":" + std::string(row.kind) + (row.matches ? "" : "?") + " ";
  return text;
}

TEST_F(Actions, TheTreeShowsEverythingBelowWhatItBelongsTo) {
  make("point", "bulb", world.node("table"));
  TreeQuery query;
  EXPECT_EQ(drawn(treeRows(document, query)),
            "small.lmb.glb:bundle .table:node ..lamp:light ..ball:node ..bulb:light .camera:camera "
            ".tube:lamp .roll:animation .tube:material ");
  query.closed.insert(document.idOf(world.node("table")));
  EXPECT_EQ(drawn(treeRows(document, query)),
            "small.lmb.glb:bundle .table:node .camera:camera .tube:lamp .roll:animation .tube:material ");
}

TEST_F(Actions, FiltersKeepMatchesAndThoseAboveThem) {
  TreeQuery query;
  const auto found = [&](const char* filter) {
    query.filter = filter;
    return drawn(treeRows(document, query));
  };
  EXPECT_EQ(found("BALL"), "small.lmb.glb:bundle? .table:node? ..ball:node ");
  EXPECT_EQ(found("type:light"), "small.lmb.glb:bundle? .table:node? ..lamp:light ");
  EXPECT_EQ(found("has:lamp"), "small.lmb.glb:bundle? .tube:lamp ");
  EXPECT_EQ(found("has:Transform -type:node a"),
            "small.lmb.glb:bundle .table:node? ..lamp:light .camera:camera ");
  EXPECT_EQ(found("\"no such\""), "");
  EXPECT_EQ(found(("id:" + idText(document.idOf(world.node("ball"))).substr(0, 8)).c_str()),
            "small.lmb.glb:bundle? .table:node? ..ball:node ");
}

TEST_F(Actions, RowsAreMadeAgainWhenTheTreeChangesAndNotWhenThingsMove) {
  const std::uint64_t before = treeVersion(world.registry);
  ASSERT_TRUE(history.setField(world.node("ball"), "Transform", "translation", glm::vec3(3.0f)));
  EXPECT_EQ(treeVersion(world.registry), before);
  ASSERT_TRUE(history.reparent(world.node("ball"), world.node("lamp"), true));
  EXPECT_NE(treeVersion(world.registry), before);
}

}  // namespace
}  // namespace lambent::editor
