// The scene `field` has 200 rigid groups that light and shadow each other.
#include <array>
#include <cmath>
#include <numbers>

#include "assets/scenes.hpp"
#include "assets/shapes.hpp"

namespace lambent::assets {

namespace {

constexpr int kRows = 10, kColumns = 20;  // bodies, including the lawn
constexpr int kMoving = 20;
constexpr float kSpacing = 2.4f;

// Moves once around a small circle in four seconds.
Motion circling(glm::vec3 center, float start) {
  Motion motion;
  constexpr int kKeys = 24;
  constexpr float kReach = 0.5f;
  for (int i = 0; i <= kKeys; ++i) {
    const float phase = static_cast<float>(i) / kKeys;
    const float angle = 2.0f * std::numbers::pi_v<float> * (phase + start);
    motion.times_s.push_back(4.0f * phase);
    motion.translations.push_back(center + kReach * glm::vec3(std::cos(angle), 0.3f, std::sin(angle)));
    motion.rotations.push_back(glm::angleAxis(angle, glm::vec3(0, 1, 0)));
  }
  return motion;
}

}  // namespace

Scene field() {
  Scene scene;
  scene.name = "field";
  constexpr std::array<glm::vec3, 5> kColors = {
      glm::vec3(0.75f, 0.12f, 0.08f), glm::vec3(0.80f, 0.62f, 0.15f), glm::vec3(0.10f, 0.38f, 0.62f),
      glm::vec3(0.80f, 0.79f, 0.76f), glm::vec3(0.42f, 0.20f, 0.55f)};
  scene.materials = {{.name = "lawn", .base_color = {0.16f, 0.30f, 0.09f}}};
  for (const glm::vec3& color : kColors) scene.materials.push_back({.name = "body", .base_color = color});

  const float width = kColumns * kSpacing, depth = kRows * kSpacing;
  scene.meshes.push_back(
      {"lawn", plane({-width / 2, 0, depth / 2}, {width, 0, 0}, {0, 0, -depth}, 40, 20), 0});
  scene.nodes.push_back({.name = "lawn", .mesh = 0});
  for (int color = 1; color <= static_cast<int>(kColors.size()); ++color) {
    scene.meshes.push_back({"ball", sphere(0.4f, 7), color});
    scene.meshes.push_back({"cube", box({-0.33f, -0.33f, -0.33f}, {0.33f, 0.33f, 0.33f}, 0.11f), color});
    scene.meshes.push_back({"ring",
                            torusKnot({.ring_radius = 0.26f,
                                       .torus_radius = 0.07f,
                                       .tube_radius = 0.06f,
                                       .cells_along = 60,
                                       .cells_around = 8}),
                            color});
  }
  const int kinds = static_cast<int>(scene.meshes.size()) - 1;
  for (int i = 1; i < kRows * kColumns; ++i) {
    const glm::vec3 place((static_cast<float>(i % kColumns) + 0.5f) * kSpacing - width / 2, 0.42f,
                          (static_cast<float>(i / kColumns) + 0.5f) * kSpacing - depth / 2);
    Node node{.name = "body", .mesh = 1 + i * 7 % kinds, .translation = place};
    node.movable = true;
    if (i % (kRows * kColumns / kMoving) == 1) {
      node.motion = circling(place, static_cast<float>(i % 7) / 7.0f);
      node.translation = node.motion.translations.front();
      node.rotation = node.motion.rotations.front();
    }
    scene.nodes.push_back(std::move(node));
  }
  scene.cameras = {{"main", {-8.0f, 9.5f, 21.0f}, {0, 0, 0}, 45.0f},
                   {"detail", {-3.0f, 3.0f, 8.0f}, {0, 0.4f, 1.0f}, 45.0f}};
  return scene;
}

}  // namespace lambent::assets
