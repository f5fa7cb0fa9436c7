// The scenes of few lines: `hello`, `knot` and `ring` (scenes.hpp).
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "assets/scenes.hpp"
#include "assets/shapes.hpp"

namespace lambent::assets {

Scene hello() {
  Scene scene;
  scene.name = "hello";
  scene.materials = {{.name = "floor", .base_color = {0.7f, 0.68f, 0.64f}},
                     {.name = "box", .base_color = {0.75f, 0.25f, 0.12f}},
                     {.name = "sphere", .base_color = {0.2f, 0.4f, 0.7f}}};
  scene.meshes = {{"floor", withoutTexcoords(plane({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, 0.125f)), 0},
                  {"box", box({-0.25f, 0, -0.25f}, {0.25f, 0.5f, 0.25f}, 0.125f), 1},
                  {"sphere", sphere(/*radius=*/0.3f, /*cells=*/6), 2}};
  scene.nodes = {{.name = "floor", .mesh = 0},
                 {.name = "box", .mesh = 1, .translation = {-0.4f, 0, -0.1f}},
                 {.name = "sphere", .mesh = 2, .translation = {0.4f, 0.3f, 0.15f}}};
  scene.cameras = {{"main", {1.2f, 1.3f, 2.6f}, {0, 0.2f, 0}, 36.0f},
                   {"detail", {0, 0.9f, 1.6f}, {0, 0.25f, 0}, 40.0f}};
  return scene;
}

Scene knot() {
  Scene scene;
  scene.name = "knot";
  scene.materials = {{.name = "clay", .base_color = {0.80f, 0.62f, 0.48f}}};
  scene.meshes = {{"knot", torusKnot({.tube_radius = 0.22f, .cells_along = 480, .cells_around = 40}), 0}};
  scene.nodes = {{.name = "knot", .mesh = 0}};
  scene.cameras = {{"main", {2.6f, 3.2f, 3.4f}, {0, 0, 0}, 36.0f},
                   {"detail", {0.9f, 1.2f, 2.4f}, {0.4f, 0, 0.7f}, 36.0f}};
  return scene;
}

// The scene `ring` shows a caustic: a polished ring of gold that stands on a white plane and gathers light in
// it, as in the talk on precomputed radiance transfer (Sloan, Kautz and Snyder 2002). The plane's vertices
// are as many as the texels of the talk's plane.

Scene ring() {
  constexpr int kTexels = 256;
  constexpr float kHalf = 1.25f, kInner = 0.5f, kOuter = 0.54f, kHeight = 0.24f;
  Scene scene;
  scene.name = "ring";
  scene.materials = {
      {.name = "plane", .base_color = glm::vec3(0.8f)},
      {.name = "gold", .base_color = {1.0f, 0.77f, 0.34f}, .roughness = 0.05f, .metallic = 1.0f}};
  Mesh floor = plane({-kHalf, 0, kHalf}, {2 * kHalf, 0, 0}, {0, 0, -2 * kHalf}, kTexels - 1, kTexels - 1);
  // The band has no lower side: it stands on the plane.
  const std::vector<glm::vec2> profile = {
      {kOuter, 0.0f}, {kOuter, kHeight}, {kInner, kHeight}, {kInner, 0.0f}};
  scene.meshes = {{"plane", withoutTexcoords(std::move(floor)), 0},
                  {"ring", withoutTexcoords(lathe(profile, 192, 0.04f)), 1}};
  scene.nodes = {{"plane", 0}, {"ring", 1}};
  scene.cameras = {{"main", {0.0f, 1.9f, 1.9f}, {0.0f, 0.02f, 0.08f}, 38.0f},
                   {"detail", {0.0f, 1.1f, 0.7f}, {0.0f, 0.0f, -0.12f}, 38.0f}};
  return scene;
}

// The scene `field` has 200 rigid groups that light and shadow each other.

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
      setMotion(node, circling(place, static_cast<float>(i % 7) / 7.0f));
    }
    scene.nodes.push_back(std::move(node));
  }
  scene.cameras = {{"main", {-8.0f, 9.5f, 21.0f}, {0, 0, 0}, 45.0f},
                   {"detail", {-3.0f, 3.0f, 8.0f}, {0, 0.4f, 1.0f}, 45.0f}};
  return scene;
}

// The scene `metals` shows glossy transfer: metals that reflect each other and the room, from polished to
// rough, brushed and glazed ones, and a white wall that receives their light.

namespace {

enum MetalsMaterial { kTable, kBackWall, kGold, kSteel, kGlaze, kRubber, kFirstCopper };
constexpr float kRoughnesses[] = {0.15f, 0.3f, 0.5f, 0.8f};

std::vector<Material> metalsMaterials() {
  std::vector<Material> all = {
      {.name = "table", .base_color = glm::vec3(0.55f), .image = 0, .roughness = 0.45f, .specular = 1.0f},
      {.name = "white wall", .base_color = {0.82f, 0.81f, 0.79f}},
      {.name = "gold",
       .base_color = {1.0f, 0.77f, 0.34f},
       .double_sided = true,
       .roughness = 0.3f,
       .metallic = 1.0f},
      {.name = "brushed steel",
       .base_color = {0.62f, 0.61f, 0.59f},
       .roughness = 0.35f,
       .metallic = 1.0f,
       .anisotropy = 0.85f},
      {.name = "blue glaze", .base_color = {0.05f, 0.12f, 0.42f}, .roughness = 0.2f, .specular = 1.0f},
      {.name = "rubber", .base_color = {0.62f, 0.09f, 0.06f}}};
  for (const float roughness : kRoughnesses)
    all.push_back(
        {.name = "copper", .base_color = {0.95f, 0.64f, 0.54f}, .roughness = roughness, .metallic = 1.0f});
  return all;
}

// The bowl is turned on a lathe, so its texture coordinates run around it, and so does the brushing.
Mesh turnedBowl() {
  const std::vector<glm::vec2> profile = {{0.0f, 0.0f},   {0.16f, 0.0f},  {0.17f, 0.02f},
                                          {0.10f, 0.05f}, {0.24f, 0.16f}, {0.34f, 0.34f},
                                          {0.32f, 0.34f}, {0.22f, 0.18f}, {0.0f, 0.09f}};
  return lathe(profile, 96, 0.02f);
}

}  // namespace

Scene metals() {
  Scene scene;
  scene.name = "metals";
  scene.materials = metalsMaterials();
  scene.images = {{"stone", stonePng(/*tiles=*/2, /*texels_per_tile=*/128)}};
  show(scene, "table", plane({-2.2f, 0, 1.4f}, {4.4f, 0, 0}, {0, 0, -2.8f}, 0.05f), kTable);
  show(scene, "wall", withoutTexcoords(plane({-2.2f, 0, -1.4f}, {4.4f, 0, 0}, {0, 1.8f, 0}, 0.05f)),
       kBackWall);
  show(scene, "teapot", withoutTexcoords(teapot(/*cells=*/18, /*height_m=*/0.8f)), kGold, {0.05f, 0, -0.45f},
       20.0f);
  show(scene, "bowl", turnedBowl(), kSteel, {1.22f, 0, -0.25f});
  show(scene, "knot",
       withoutTexcoords(torusKnot({.ring_radius = 0.30f,
                                   .torus_radius = 0.13f,
                                   .tube_radius = 0.07f,
                                   .cells_along = 260,
                                   .cells_around = 24})),
       kGlaze, {-1.22f, 0.21f, -0.35f});
  for (std::size_t i = 0; i < std::size(kRoughnesses); ++i)
    show(scene, "copper ball", withoutTexcoords(sphere(/*radius=*/0.2f, /*cells=*/16)),
         kFirstCopper + static_cast<int>(i), {-0.85f + 0.5f * static_cast<float>(i), 0.2f, 0.62f});
  show(scene, "rubber ball", withoutTexcoords(sphere(/*radius=*/0.16f, /*cells=*/12)), kRubber,
       {1.2f, 0.16f, 0.66f});

  scene.cameras = {{"main", {0.35f, 1.35f, 3.3f}, {0.0f, 0.32f, -0.1f}, 38.0f},
                   {"detail", {0.9f, 0.75f, 1.5f}, {0.1f, 0.3f, -0.2f}, 36.0f}};
  return scene;
}

}  // namespace lambent::assets
