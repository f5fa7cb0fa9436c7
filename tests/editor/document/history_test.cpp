#include "editor/document/history.hpp"

#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/scene/components.hpp"
#include "small_world.hpp"

namespace lambent::editor {
namespace {

using scene::Value;

// Returns every field of every component, and the parents, by id. Undo has to restore all of it.
std::map<std::string, Value> everything(const Document& document) {
  std::map<std::string, Value> all;
  const ecs::Registry& registry = document.registry();
  for (auto [entity, id] : registry.view<StableId>()) {
    for (const scene::ComponentInfo& component : scene::components()) {
      if (!component.has(registry, entity)) continue;
      for (const scene::FieldInfo& field : component.fields)
        all[idText(id) + "/" + std::string(component.name) + "/" + std::string(field.name)] =
            field.get(registry, entity);
    }
    all[idText(id) + "/parent"] = idText(document.idOf(parentOf(registry, entity)));
    all[idText(id) + "/created"] = document.created(entity);
  }
  for (const auto& [name, value] : document.world().settings) all["settings/" + name] = value;
  return all;
}

std::string firstDifference(const std::map<std::string, Value>& a, const std::map<std::string, Value>& b) {
  for (const auto& [name, value] : a) {
    const auto other = b.find(name);
    if (other == b.end()) return name + " is gone";
    if (!scene::sameBits(value, other->second))
      return name + ": " + scene::valueText(value) + " became " + scene::valueText(other->second);
  }
  for (const auto& [name, value] : b)
    if (!a.contains(name)) return name + " is new";
  return "";
}

class Editing : public ::testing::Test {
 protected:
  testing::SmallWorld world;
  Document document{world.registry, 1};
  History history{document};

  float strength(ecs::Entity light) const {
    return world.registry.get<scene::LocalLightComponent>(light).strength;
  }
};

// Makes random edits of every kind, by a fixed seed.
class RandomEditor {
 public:
  RandomEditor(Document& document, History& history) : document_(document), history_(history) {}

  void step() {
    const unsigned kind = below(20);
    if (kind < 10) return editField();
    if (kind == 10) return static_cast<void>(create());
    if (kind == 11) return destroy();
    if (kind == 12 || kind == 13) return reparent();
    if (kind == 14) return static_cast<void>(history_.addComponent(pick(), below(2) ? "Light" : "Camera"));
    if (kind == 15) return static_cast<void>(history_.removeComponent(pick(), below(2) ? "Light" : "Camera"));
    if (kind == 16) {
      WorldState state = document_.world();
      state.settings["exposure"] = std::to_string(below(9));
      return history_.setWorld(std::move(state), "settings");
    }
    history_.begin("several");
    for (unsigned i = below(6); i-- > 0;) below(3) ? editField() : step();
    below(4) ? history_.commit() : history_.cancel();
  }
  unsigned below(unsigned limit) { return static_cast<unsigned>(random_() % limit); }

 private:
  ecs::Entity pick() {
    std::vector<ecs::Entity> all;
    for (auto [entity, id] : document_.registry().view<StableId>()) all.push_back(entity);
    std::sort(all.begin(), all.end());
    return all[below(static_cast<unsigned>(all.size()))];
  }
  float number() { return static_cast<float>(below(2000)) / 1000.0f; }

  Value valueFor(const scene::FieldInfo& field) {
    switch (field.kind) {
      case scene::ValueKind::Flag:
        return below(2) == 0;
      case scene::ValueKind::Whole:
        return static_cast<std::int32_t>(below(9));
      case scene::ValueKind::Number:
        return number();
      case scene::ValueKind::Vector:
        return glm::vec3(number(), number(), number());
      case scene::ValueKind::Rotation:
        return glm::normalize(glm::quat(0.1f + number(), number(), -number(), number()));
      case scene::ValueKind::Text:
        return "name " + std::to_string(below(99));
      case scene::ValueKind::Word:
        return scene::Word{std::string(field.words[below(static_cast<unsigned>(field.words.size()))])};
    }
    return false;
  }
  void editField() {
    std::vector<FieldEdit> edits;
    for (unsigned i = 1 + below(3); i-- > 0;) {
      const ecs::Entity entity = pick();
      const auto& component = scene::components()[below(static_cast<unsigned>(scene::components().size()))];
      if (!component.has(document_.registry(), entity)) continue;
      const auto& field = component.fields[below(static_cast<unsigned>(component.fields.size()))];
      edits.push_back({entity, component.name, field.name, valueFor(field)});
    }
    // The value may be out of range, and then nothing happens.
    static_cast<void>(history_.setFields(edits));
  }
  bool create() {
    EntitySnapshot light = lightEntity(below(2) ? "sphere" : "spot", "light");
    if (below(2)) light.parent = document_.idOf(pick());
    return history_.create(light).has_value();
  }
  void destroy() {
    const ecs::Entity doomed[] = {pick(), pick()};
    static_cast<void>(history_.destroy(std::span(doomed).first(1 + below(2))));
  }
  void reparent() {
    const ecs::Entity children[] = {pick(), pick()};
    static_cast<void>(history_.reparent(std::span(children).first(1 + below(2)),
                                        below(4) ? pick() : ecs::Entity{}, below(2) == 0));
  }

  Document& document_;
  History& history_;
  std::mt19937 random_{20};
};

TEST_F(Editing, UndoRestoresEveryByteOfEveryFieldAfterAThousandRandomEdits) {
  RandomEditor editor(document, history);
  std::vector<std::map<std::string, Value>> states{everything(document)};  // by steps done
  int undone = 0;
  for (int i = 0; i < 1000; ++i) {
    if (editor.below(8) == 0) {
      const Replay replay = editor.below(3) ? history.undo() : history.redo();
      EXPECT_TRUE(replay.missing.empty()) << replay.name << ": " << replay.missing.front();
      undone += replay.done;
      ASSERT_EQ(firstDifference(states[history.stepsDone()], everything(document)), "") << replay.name;
      continue;
    }
    const std::size_t done = history.stepsDone();
    editor.step();
    if (history.stepsDone() == done) {  // refused, cancelled, or nothing new
      ASSERT_EQ(firstDifference(states[done], everything(document)), "") << "changed without a step";
      continue;
    }
    states.resize(history.stepsDone());
    states.push_back(everything(document));
  }
  EXPECT_GT(undone, 50);
  ASSERT_GT(history.stepsDone(), 300u);
  const std::size_t steps = history.stepsDone();
  while (history.canUndo()) {
    const Replay replay = history.undo();
    ASSERT_TRUE(replay.missing.empty()) << replay.missing.front();
    ASSERT_EQ(firstDifference(states[history.stepsDone()], everything(document)), "")
        << "undoing " << replay.name;
  }
  EXPECT_FALSE(history.modified());
  while (history.canRedo()) {
    ASSERT_TRUE(history.redo().missing.empty());
    ASSERT_EQ(firstDifference(states[history.stepsDone()], everything(document)), "");
  }
  EXPECT_EQ(history.stepsDone(), steps);
}

TEST_F(Editing, ADragIsOneStepAndOneThatComesBackIsNone) {
  const ecs::Entity lamp = world.node("lamp");
  history.begin("drag");
  for (int i = 0; i <= 100; ++i)
    ASSERT_TRUE(history.setField(lamp, "Light", "strength", 0.1f * static_cast<float>(i)));
  history.commit();
  EXPECT_EQ(history.undoName(), "Undo drag");
  history.begin("to and fro");
  ASSERT_TRUE(history.setField(lamp, "Light", "strength", 3.0f));
  ASSERT_TRUE(history.setField(lamp, "Light", "strength", 10.0f));
  history.commit();
  EXPECT_EQ(history.stepsDone(), 1u);
  EXPECT_TRUE(history.undo().done);
  EXPECT_EQ(strength(lamp), 7.0f) << "the bundle's";
}

TEST_F(Editing, CancelTakesBackTheInnerStepAndKeepsTheOuter) {
  const ecs::Entity lamp = world.node("lamp");
  history.begin("outer");
  ASSERT_TRUE(history.setField(lamp, "Light", "strength", 1.0f));
  history.begin("inner");
  ASSERT_TRUE(history.setField(lamp, "Light", "strength", 2.0f));
  history.cancel();
  EXPECT_EQ(strength(lamp), 1.0f);
  history.commit();
  history.undo();
  EXPECT_EQ(strength(lamp), 7.0f);
}

TEST_F(Editing, AFieldBeforeAndAfterItsComponentWasMadeAnewIsTwoChanges) {
  const ecs::Entity bulb = *history.create(lightEntity("point", "bulb"));
  const auto before = everything(document);
  history.begin("another light");
  ASSERT_TRUE(history.setField(bulb, "Light", "strength", 2.0f));
  ASSERT_TRUE(history.removeComponent(bulb, "Light"));
  ASSERT_TRUE(history.addComponent(bulb, "Light"));
  ASSERT_TRUE(history.setField(bulb, "Light", "strength", 5.0f));
  history.commit();
  history.undo();
  EXPECT_EQ(firstDifference(before, everything(document)), "");
  history.redo();
  EXPECT_EQ(strength(bulb), 5.0f);
}

TEST_F(Editing, WhatHangsBelowAnotherOfTheSelectionMovesWithThat) {
  const ecs::Entity stand = *history.create(emptyEntity("stand"));
  const ecs::Entity table = world.node("table"), ball = world.node("ball");
  const ecs::Entity both[] = {ball, table};
  ASSERT_TRUE(history.reparent(both, stand, true));
  EXPECT_EQ(parentOf(world.registry, table), stand);
  EXPECT_EQ(parentOf(world.registry, ball), table);
}

TEST_F(Editing, ErrorsChangeNothingAndNameFieldAndEntity) {
  const ecs::Entity lamp = world.node("lamp");
  const std::uint64_t version = world.registry.version<scene::LocalLightComponent>();
  const FieldEdit edits[] = {{lamp, "Light", "strength", 2.0f}, {lamp, "Light", "outer_cone", std::nanf("")}};
  const Result<void> refused = history.setFields(edits);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().line(), "Light.outer_cone of lamp: is not a finite number");
  EXPECT_EQ(world.registry.version<scene::LocalLightComponent>(), version);
  EXPECT_FALSE(history.modified());
  EXPECT_FALSE(history.destroy(lamp)) << "it is the bundle's";
  EXPECT_FALSE(history.reparent(world.node("table"), lamp, true)) << "a circle";
  EXPECT_FALSE(history.canUndo());
}

TEST_F(Editing, NamesOfStepsSayWhatMenusShow) {
  const ecs::Entity ball = world.node("ball"), lamp = world.node("lamp");
  ASSERT_TRUE(history.setField(ball, "Transform", "translation", glm::vec3(1.0f)));
  EXPECT_EQ(history.undoName(), "Undo move of ball");
  const FieldEdit both[] = {{ball, "Transform", "rotation", glm::quat(0.0f, 1.0f, 0.0f, 0.0f)},
                            {lamp, "Transform", "rotation", glm::quat(0.0f, 1.0f, 0.0f, 0.0f)}};
  ASSERT_TRUE(history.setFields(both));
  EXPECT_EQ(history.undoName(), "Undo turn of 2 entities");
  history.undo();
  EXPECT_EQ(history.redoName(), "Redo turn of 2 entities");
}

TEST_F(Editing, TheStateThatWasSavedIsFoundAgainUnlessItIsOutOfReach) {
  const ecs::Entity lamp = world.node("lamp");
  ASSERT_TRUE(history.setField(lamp, "Light", "strength", 1.0f));
  history.markSaved();
  EXPECT_FALSE(history.modified());
  history.undo();
  EXPECT_TRUE(history.modified());
  history.redo();
  EXPECT_FALSE(history.modified());
  history.undo();
  ASSERT_TRUE(history.setField(lamp, "Light", "strength", 2.0f));
  history.undo();
  EXPECT_TRUE(history.modified()) << "what was saved cannot be reached any more";
}

TEST_F(Editing, OldStepsAreForgottenWhereMemoryIsBounded) {
  History small(document, 20000);
  const ecs::Entity lamp = world.node("lamp");
  for (int i = 1; i <= 100; ++i)
    ASSERT_TRUE(small.setField(lamp, "Light", "strength", static_cast<float>(i)));
  EXPECT_LE(small.bytes(), 20000u);
  EXPECT_GT(small.stepsDone(), 2u);
  const auto kept = static_cast<float>(small.stepsDone());
  while (small.canUndo()) small.undo();
  EXPECT_EQ(strength(lamp), 100.0f - kept);
  EXPECT_TRUE(small.modified());
}

TEST_F(Editing, StepsOutliveABundleThatIsLoadedAgain) {
  ASSERT_TRUE(history.setField(world.node("lamp"), "Light", "strength", 1.0f));
  ASSERT_TRUE(history.setField(world.node("ball"), "Name", "name", "marble"));
  scene::destroyInstance(world.registry, world.instance);
  const Replay lost = history.undo();
  EXPECT_EQ(lost.missing.size(), 1u);
  history.redo();
  world.add(0);
  ASSERT_TRUE(history.undo().missing.empty());
  ASSERT_TRUE(history.undo().missing.empty());
  EXPECT_EQ(strength(world.node("lamp")), 7.0f);
  ASSERT_TRUE(history.redo().missing.empty());
  EXPECT_EQ(strength(world.node("lamp")), 1.0f);
}

TEST_F(Editing, DestroyedEntitiesComeBackWithChildrenAndTheirIds) {
  const ecs::Entity stand = *history.create(emptyEntity("stand"));
  EntitySnapshot bulb = lightEntity("point", "bulb");
  bulb.parent = document.idOf(stand);
  const StableId bulb_id = document.idOf(*history.create(bulb));
  ASSERT_TRUE(history.reparent(world.node("table"), stand, true));
  ASSERT_TRUE(history.setField(stand, "Transform", "translation", glm::vec3(0.0f, 3.0f, 0.0f)));
  const glm::mat4 table = worldFromNode(world.registry, world.node("table"));
  const auto before = everything(document);
  ASSERT_TRUE(history.destroy(stand));
  EXPECT_FALSE(document.find(bulb_id));
  EXPECT_EQ(worldFromNode(world.registry, world.node("table")), table) << "the bundle's stays where it was";
  history.undo();
  EXPECT_EQ(firstDifference(before, everything(document)), "");
  EXPECT_TRUE(document.find(bulb_id));
}

}  // namespace
}  // namespace lambent::editor
