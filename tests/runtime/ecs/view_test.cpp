#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/ecs/registry.hpp"

namespace lambent::ecs {
namespace {

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

TEST(View, MayDestroyTheEntityInHand) {
  Fixture f(100);
  int visits = 0;
  for (auto [entity, a] : f.registry.view<A>()) {
    ++visits;
    if (a.value % 2 == 0) f.registry.destroy(entity);
  }
  EXPECT_EQ(visits, 100);
  EXPECT_EQ(f.registry.count<A>(), 50u);
}

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

}  // namespace
}  // namespace lambent::ecs
