#include "editor/document/actions.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "editor/document/field_edits.hpp"
#include "editor/document/selection.hpp"
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

TEST_F(Actions, CopiesOfComponentsGoOntoSeveralEntitiesInOneStep) {
  const ecs::Entity lamp = world.node("lamp"), bulb = make("disc", "bulb"),
                    stand = *history.create(emptyEntity("stand"));
  ASSERT_TRUE(history.setField(bulb, "Light", "color", glm::vec3(0.1f, 0.2f, 0.3f)));
  const std::string text = *copyComponent(document, bulb, "Light");
  EXPECT_EQ(peekClip(text), Pasted::Component);
  const ecs::Entity both[] = {lamp, stand};
  const Result<void> pasted = pasteComponent(document, history, both, text);
  ASSERT_TRUE(pasted) << pasted.error().line();
  EXPECT_EQ(light(lamp).color, glm::vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(light(stand).kind, scene::LocalLightComponent::Kind::Disc) << "what lacks it gets one";
  history.undo();
  EXPECT_EQ(light(lamp).strength, 7.0f);
  EXPECT_FALSE(world.registry.has<scene::LocalLightComponent>(stand));
}

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

TEST_F(Actions, WhatDoesNotFitChangesNothing) {
  const ecs::Entity lamp = world.node("lamp"), ball = world.node("ball");
  const std::string text = *copyComponent(document, lamp, "Light");
  const std::size_t steps = history.stepsDone();
  const ecs::Entity both[] = {make("point", "bulb"), ball};
  const Result<void> refused = pasteComponent(document, history, both, text);
  ASSERT_FALSE(refused) << "the ball is the bundle's";
  EXPECT_NE(refused.error().line().find("ball"), std::string::npos);
  EXPECT_EQ(light(both[0]).strength, 1.0f);
  EXPECT_EQ(history.stepsDone(), steps + 1) << "the bulb alone";

  EXPECT_NE(pasteComponent(document, history, both, "hello").error().line().find("nothing that was copied"),
            std::string::npos);
  std::string wrong = text;
  wrong.replace(wrong.find("7.0"), 3, "\"7\"");
  EXPECT_NE(pasteComponent(document, history, both, wrong).error().line().find("fields.strength"),
            std::string::npos);
  EXPECT_FALSE(pasteEntities(document, history, {}, text));
  EXPECT_EQ(peekClip("{}"), Pasted::Nothing);
}

TEST_F(Actions, EntitiesGoToAnotherProgramWithWhatHangsBelow) {
  const ecs::Entity stand = *history.create(emptyEntity("stand"));
  make("spot", "bulb", stand);
  const std::string text = *copyEntities(document, {&stand, 1});
  testing::SmallWorld other_world;
  Document other(other_world.registry, 1);  // even where it gives the same ids
  History steps(other);
  ASSERT_TRUE(steps.create(emptyEntity("another")));
  const auto made = pasteEntities(other, steps, other_world.node("table"), text);
  ASSERT_TRUE(made) << made.error().line();
  ASSERT_EQ(made->size(), 1u);
  EXPECT_EQ(other.nameOf((*made)[0]), "stand");
  EXPECT_EQ(parentOf(other_world.registry, (*made)[0]), other_world.node("table"));
  EXPECT_EQ(withDescendants(other_world.registry, *made).size(), 2u);
  steps.undo();
  EXPECT_EQ(other_world.registry.count<Created>(), 1u);
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
            "small.lmb.glb:bundle .table:node ..lamp:light ..ball:node ..primitive 0:draw ..bulb:light "
            ".camera:camera .scene:group ..tube:lamp .roll:animation .tube:material ");
  query.show_parts = false;
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
  EXPECT_EQ(found("has:lamp"), "small.lmb.glb:bundle? .scene:group? ..tube:lamp ");
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

// Returns what the typed text makes of 10.
double ofTen(std::string_view text) {
  const auto edit = parseNumberEdit(text);
  EXPECT_TRUE(edit) << text;
  return edit ? edit->appliedTo(10.0) : -1.0;
}

TEST(NumberEdit, CalculatesWhatIsTyped) {
  EXPECT_EQ(ofTen("2.5"), 2.5);
  EXPECT_EQ(ofTen("-3"), -3.0) << "a number, not a difference";
  EXPECT_EQ(ofTen(" 2*3 + 1 "), 7.0);
  EXPECT_EQ(ofTen("1+2*3"), 7.0);
  EXPECT_EQ(ofTen("(1+2)*-3"), -9.0);
  EXPECT_EQ(ofTen("1e2/4"), 25.0);
}

TEST(NumberEdit, ShiftsAndScalesTheNumberThatIsThere) {
  EXPECT_EQ(ofTen("+=1"), 11.0);
  EXPECT_EQ(ofTen("-= 2*2"), 6.0);
  EXPECT_EQ(ofTen("*2"), 20.0);
  EXPECT_EQ(ofTen("*=1.5"), 15.0);
  EXPECT_EQ(ofTen("/4"), 2.5);
}

TEST(NumberEdit, RefusesWhatHasNoFiniteResult) {
  for (const char* text : {"", " ", "2*", "two", "1/0", "/0", "nan", "inf", "1e999", "(1", "1)", "+=", "2 3"})
    EXPECT_FALSE(parseNumberEdit(text)) << text;
  EXPECT_FALSE(parseNumberEdit(std::string(100'000, '('))) << "without running out of stack";
}

}  // namespace
}  // namespace lambent::editor
