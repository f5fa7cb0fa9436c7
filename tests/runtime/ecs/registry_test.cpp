#include "runtime/ecs/registry.hpp"

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/ecs/fields.hpp"

namespace lambent::ecs {
namespace {

struct Position {
  float x = 0, y = 0;
};
struct Tag {};

TEST(Registry, AHandleIsStaleAfterDestructionEvenWhenItsIndexIsUsedAgain) {
  Registry registry;
  const Entity first = registry.create();
  registry.emplace<Position>(first, 1.0f, 2.0f);
  EXPECT_TRUE(registry.destroy(first));
  EXPECT_FALSE(registry.destroy(first));
  const Entity second = registry.create();
  EXPECT_EQ(second.index, first.index);
  EXPECT_FALSE(registry.alive(first));
  EXPECT_TRUE(registry.alive(second));
  EXPECT_EQ(registry.tryGet<Position>(second), nullptr) << "components do not pass on to the next entity";
  registry.emplace<Position>(second, 3.0f, 4.0f);
  EXPECT_EQ(registry.tryGet<Position>(first), nullptr);
  EXPECT_FALSE(registry.has<Position>(first));
  EXPECT_FALSE(registry.remove<Position>(first));
  EXPECT_EQ(registry.get<Position>(second).x, 3.0f);
}

TEST(Registry, EveryChangeRaisesTheVersionOfItsComponentOnly) {
  Registry registry;
  const Entity a = registry.create(), b = registry.create();
  EXPECT_EQ(registry.version<Position>(), 0u);
  registry.emplace<Position>(a);
  registry.emplace<Position>(b);
  registry.emplace<Tag>(a);
  std::uint64_t seen = registry.version<Position>();
  const std::uint64_t seen_tag = registry.version<Tag>(), seen_b = registry.version<Position>(b);

  registry.touch<Position>(a);
  EXPECT_GT(registry.version<Position>(), std::exchange(seen, registry.version<Position>()));
  EXPECT_EQ(registry.version<Position>(a), seen);
  EXPECT_EQ(registry.version<Position>(b), seen_b) << "touching one entity leaves the others' versions alone";
  registry.edit<Position>(b).x = 5.0f;
  EXPECT_GT(registry.version<Position>(), std::exchange(seen, registry.version<Position>()));
  registry.emplace<Position>(a, 9.0f, 9.0f);
  EXPECT_GT(registry.version<Position>(), std::exchange(seen, registry.version<Position>()))
      << "replacing counts";
  registry.destroy(b);
  EXPECT_GT(registry.version<Position>(), std::exchange(seen, registry.version<Position>()));
  EXPECT_EQ(registry.version<Position>(b), 0u);
  registry.get<Position>(a).x = 1.0f;
  EXPECT_EQ(registry.version<Position>(), seen) << "reading does not count";
  EXPECT_EQ(registry.version<Tag>(), seen_tag);
}

TEST(Registry, ComponentsMayBeMoveOnlyAndAreDestroyedWithTheirEntity) {
  Registry registry;
  auto counted = std::make_shared<int>(7);
  struct Owner {
    std::unique_ptr<std::shared_ptr<int>> value;
  };
  const Entity a = registry.create(), b = registry.create();
  registry.emplace<Owner>(a, std::make_unique<std::shared_ptr<int>>(counted));
  registry.emplace<Owner>(b, std::make_unique<std::shared_ptr<int>>(counted));
  EXPECT_EQ(counted.use_count(), 3);
  registry.destroy(a);  // b's value moves into the gap
  EXPECT_EQ(counted.use_count(), 2);
  EXPECT_EQ(**registry.get<Owner>(b).value, 7);
  { const Registry taken = std::move(registry); }
  EXPECT_EQ(counted.use_count(), 1);
}

// Compares the registry with the simplest model: a map per component, and a set of living entities.
TEST(Registry, DoesWhatMapsDoOverRandomOperations) {
  struct Model {
    std::map<Entity, int> number;
    std::map<Entity, std::string> word;
  } model;
  std::vector<Entity> alive, dead;
  Registry registry;
  std::mt19937 random(20020721);
  const auto pick = [&](const std::vector<Entity>& from) { return from[random() % from.size()]; };

  for (int step = 0; step < 40000; ++step) {
    const auto what = random() % 8;
    if (what <= 1 || alive.empty()) {
      alive.push_back(registry.create());
    } else if (what == 2) {
      const std::size_t at = random() % alive.size();
      const Entity entity = alive[at];
      alive.erase(alive.begin() + static_cast<std::ptrdiff_t>(at));
      dead.push_back(entity);
      ASSERT_TRUE(registry.destroy(entity));
      model.number.erase(entity);
      model.word.erase(entity);
    } else if (what == 3) {
      const Entity entity = pick(alive);
      model.number[entity] = step;
      registry.emplace<int>(entity, step);
    } else if (what == 4) {
      const Entity entity = pick(alive);
      model.word[entity] = std::to_string(step);
      registry.emplace<std::string>(entity, std::to_string(step));
    } else if (what == 5) {
      const Entity entity = pick(alive);
      ASSERT_EQ(registry.remove<int>(entity), model.number.erase(entity) == 1);
    } else if (what == 6) {
      const Entity entity = pick(alive);
      ASSERT_EQ(registry.remove<std::string>(entity), model.word.erase(entity) == 1);
    } else if (!dead.empty()) {
      const Entity entity = pick(dead);
      ASSERT_FALSE(registry.alive(entity));
      ASSERT_EQ(registry.tryGet<int>(entity), nullptr);
      ASSERT_EQ(registry.tryGet<std::string>(entity), nullptr);
    }
    if (step % 1000 != 0) continue;
    ASSERT_EQ(registry.entities().size(), alive.size());
    std::map<Entity, int> numbers;
    for (auto [entity, number] : registry.view<int>()) ASSERT_TRUE(numbers.emplace(entity, number).second);
    ASSERT_EQ(numbers, model.number);
    std::map<Entity, std::string> words;
    for (auto [entity, word, number] : std::as_const(registry).view<std::string, int>()) {
      ASSERT_EQ(number, model.number.at(entity));
      words.emplace(entity, word);
    }
    std::map<Entity, std::string> expected;
    for (const auto& [entity, word] : model.word) {
      if (model.number.contains(entity)) expected.emplace(entity, word);
    }
    ASSERT_EQ(words, expected);
  }
}

struct A {
  int value = 0;
};
struct B {};

struct Fixture {
  explicit Fixture(int count) {
    for (int i = 0; i < count; ++i) {
      entities.push_back(registry.create());
      registry.emplace<A>(entities.back(), i);
    }
  }
  Registry registry;
  std::vector<Entity> entities;
};

TEST(View, LeavesOutWhatTheLoopDestroyedAndVisitsTheRestOnce) {
  Fixture f(100);
  std::set<Entity> visited;
  for (auto [entity, a] : f.registry.view<A>()) {
    EXPECT_TRUE(visited.insert(entity).second);
    const int value = a.value;
    if (value < 50) f.registry.destroy(f.entities[static_cast<std::size_t>(99 - value)]);
  }
  EXPECT_EQ(visited.size(), 50u);
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(visited.contains(f.entities[static_cast<std::size_t>(i)]));
}

TEST(View, DoesNotVisitWhatTheLoopCreatesEvenInAReusedSlot) {
  Fixture f(10);
  int visits = 0;
  for (auto [entity, a] : f.registry.view<A>()) {
    ++visits;
    f.registry.destroy(entity);
    f.registry.emplace<A>(f.registry.create(), 100);
  }
  EXPECT_EQ(visits, 10);
  EXPECT_EQ(f.registry.count<A>(), 10u);
}

TEST(View, MayRemoveAComponentThatItIterates) {
  Fixture f(10);
  for (const Entity entity : f.entities) f.registry.emplace<B>(entity);
  int visits = 0;
  for ([[maybe_unused]] auto [entity, a, b] : f.registry.view<A, B>()) {
    ++visits;
    for (const Entity other : f.entities) f.registry.remove<B>(other);
  }
  EXPECT_EQ(visits, 1);
  EXPECT_EQ(f.registry.count<A>(), 10u);
}

struct Lamp {
  float power_cd = 1.0f;
  int samples = 4;
  bool lit = true;
  std::string note = "new";
  int derived = 0;

  static constexpr std::string_view kComponentName = "Lamp";
  static auto fields() {
    return std::tuple{Field{"power", &Lamp::power_cd, 1.0f, "cd", Range{0.0f, 1000.0f}},
                      Field{"samples", &Lamp::samples, 4, "", Range{1, 64}}, Field{"lit", &Lamp::lit, true},
                      Field{"note", &Lamp::note, "new"}};
  }
};

TEST(Fields, AreVisitedByNameInTheOrderOfTheirDeclaration) {
  Lamp lamp;
  std::vector<std::string> names;
  forEachField(lamp, [&](const auto& field, auto& value) {
    names.emplace_back(field.name);
    EXPECT_EQ(value, field.default_value);
    if constexpr (std::is_same_v<std::remove_reference_t<decltype(value)>, float>) value = 2.5f;
  });
  EXPECT_EQ(names, (std::vector<std::string>{"power", "samples", "lit", "note"})) << "not what is derived";
  EXPECT_EQ(lamp.power_cd, 2.5f);
}

TEST(Fields, RangesIncludeTheirEndsAndExcludeNan) {
  const auto power = std::get<0>(Lamp::fields());
  EXPECT_EQ(power.unit, "cd");
  EXPECT_TRUE(withinRange(power, 0.0f));
  EXPECT_TRUE(withinRange(power, 1000.0f));
  EXPECT_FALSE(withinRange(power, -0.001f));
  EXPECT_FALSE(withinRange(power, std::nanf("")));
  EXPECT_TRUE(withinRange(std::get<2>(Lamp::fields()), false)) << "a field without a range takes any value";
}

}  // namespace
}  // namespace lambent::ecs
