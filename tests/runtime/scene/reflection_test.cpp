#include "runtime/scene/reflection.hpp"

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "runtime/scene/components.hpp"

namespace lambent::scene {
namespace {

TEST(Reflection, EveryFieldOfEveryComponentTakesItsDefaultAndGivesItBack) {
  std::set<std::string> names;
  for (const ComponentInfo& component : components()) {
    EXPECT_TRUE(names.insert(std::string(component.name)).second) << component.name << " stands there twice";
    ecs::Registry registry;
    const ecs::Entity entity = registry.create();
    EXPECT_FALSE(component.has(registry, entity));
    component.add(registry, entity);
    ASSERT_TRUE(component.has(registry, entity)) << component.name;
    for (const FieldInfo& field : component.fields) {
      EXPECT_TRUE(sameBits(field.get(registry, entity), field.default_value))
          << component.name << "." << field.name << ": declared and made defaults differ";
      const Result<void> set = field.set(registry, entity, field.default_value);
      EXPECT_TRUE(set) << set.error().line();
      EXPECT_EQ(*findField(component.name, field.name), &field);
    }
    EXPECT_TRUE(component.remove(registry, entity));
    EXPECT_FALSE(component.fields[0].set(registry, entity, component.fields[0].default_value));
  }
}

TEST(Reflection, RefusesWhatDoesNotFitAndSaysWhy) {
  ecs::Registry registry;
  const ecs::Entity entity = registry.create();
  registry.emplace<LocalLightComponent>(entity);
  registry.emplace<Transform>(entity);
  const std::uint64_t version = registry.version<LocalLightComponent>();
  const auto error = [&](const char* component, const char* field, const Value& value) {
    const Result<void> set = (*findField(component, field))->set(registry, entity, value);
    return set ? std::string("no error") : set.error().line();
  };
  EXPECT_EQ(error("Light", "strength", std::nanf("")), "Light.strength: is not a finite number");
  EXPECT_EQ(error("Light", "strength", -1.0f), "Light.strength: -1 lies outside 0..1000000000");
  EXPECT_EQ(error("Light", "strength", true), "Light.strength: takes a number, not true or false");
  EXPECT_EQ(error("Light", "kind", Word{"lantern"}),
            "Light.kind: knows no \"lantern\"; use point, spot, directional, sphere, disc");
  EXPECT_EQ(error("Light", "color", glm::vec3(1.0f, -1.0f, 0.0f)),
            "Light.color: (1, -1, 0) is a color with a negative part");
  EXPECT_EQ(error("Transform", "translation", glm::vec3(std::numeric_limits<float>::infinity())),
            "Transform.translation: is not finite; give three finite numbers");
  EXPECT_EQ(error("Transform", "rotation", glm::quat(0.0f, 0.0f, 0.0f, 0.0f)),
            "Transform.rotation: is no rotation: its length is 0; give a unit quaternion");
  EXPECT_EQ(registry.version<LocalLightComponent>(), version) << "what is refused changes nothing";
  EXPECT_EQ(findField("Light", "power").error().hint,
            "use kind, color, strength, radius, range, inner_cone, outer_cone, enabled");
}

TEST(Reflection, EnumsGoByWords) {
  ecs::Registry registry;
  const ecs::Entity entity = registry.create();
  registry.emplace<LocalLightComponent>(entity);
  const FieldInfo& kind = **findField("Light", "kind");
  for (const std::string_view word : kind.words) {
    const std::uint64_t version = registry.version<LocalLightComponent>();
    ASSERT_TRUE(kind.set(registry, entity, Word{std::string(word)}));
    EXPECT_EQ(kind.get(registry, entity), Value(Word{std::string(word)}));
    EXPECT_GT(registry.version<LocalLightComponent>(), version) << "setting counts as an edit";
  }
  EXPECT_EQ(registry.get<LocalLightComponent>(entity).kind, LocalLightComponent::Kind::Disc);
}

}  // namespace
}  // namespace lambent::scene
