// The scene `playroom` shows moving light: a ball that tints the wall it rolls along, a lamp that swings, and
// a screen that keeps its light from the teapot.
#include <cmath>
#include <numbers>

#include "assets/scenes.hpp"
#include "assets/shapes.hpp"
#include "assets/teapot.hpp"

namespace lambent::assets {

namespace {

constexpr float kRoomHalfWidth = 2.4f, kRoomBack = -1.2f, kRoomFront = 1.8f, kRoomHeight = 2.2f;
constexpr float kCell = 0.06f;

enum PlayroomMaterial { kFloor, kWhiteWall, kRedBall, kTeapotPorcelain, kWood, kBrass };

// Rolls there and back along the wall in ten seconds, without slipping.
Motion rolling(float radius) {
  Motion motion;
  constexpr int kKeys = 40;
  constexpr float kReach = 1.7f;
  for (int i = 0; i <= kKeys; ++i) {
    const float phase = static_cast<float>(i) / kKeys;
    const float x = -kReach * std::cos(2.0f * std::numbers::pi_v<float> * phase);
    motion.times_s.push_back(10.0f * phase);
    motion.translations.emplace_back(x, radius, kRoomBack + radius + 0.12f);
    motion.rotations.push_back(glm::angleAxis(-x / radius, glm::vec3(0, 0, 1)));
  }
  return motion;
}

// Swings the lamp's arm to and fro about its hook.
Motion swinging(glm::vec3 hook) {
  Motion motion;
  constexpr int kKeys = 32;
  for (int i = 0; i <= kKeys; ++i) {
    const float phase = static_cast<float>(i) / kKeys;
    motion.times_s.push_back(5.0f * phase);
    motion.translations.push_back(hook);
    motion.rotations.push_back(
        glm::angleAxis(0.42f * std::sin(2.0f * std::numbers::pi_v<float> * phase), glm::vec3(0, 0, 1)));
  }
  return motion;
}

// Slides between lamp and teapot, and away to the side for a while.
Motion sliding() {
  constexpr float kOver = 1.28f, kBefore = 0.5f, kAway = 2.1f, kBetween = 0.95f;
  Motion motion;
  motion.times_s = {0.0f, 2.0f, 4.0f, 6.0f, 8.0f, 10.0f};
  for (const float x : {kAway, kAway, kBetween, kBetween, kAway, kAway})
    motion.translations.emplace_back(x, kOver, kBefore);
  return motion;
}

// Makes an open shade around the bulb, hanging from the origin of the arm.
Mesh lampShade(float arm) {
  const std::vector<glm::vec2> profile = {
      {0.0f, 0.0f}, {0.17f, -0.20f}, {0.155f, -0.20f}, {0.03f, -0.03f}, {0.0f, -0.03f}};
  std::vector<glm::vec2> upwards(profile.rbegin(), profile.rend());
  Mesh shade = lathe(upwards, 48, 0.03f), mesh;
  append(mesh, shade, glm::mat4(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -arm, 0, 1));
  return mesh;
}

}  // namespace

Scene playroom() {
  Scene scene;
  scene.name = "playroom";
  scene.materials = {{.name = "floor", .base_color = {0.52f, 0.47f, 0.41f}},
                     {.name = "white wall", .base_color = {0.85f, 0.85f, 0.83f}},
                     {.name = "red ball", .base_color = {0.80f, 0.05f, 0.04f}},
                     {.name = "porcelain", .base_color = {0.82f, 0.81f, 0.78f}, .double_sided = true},
                     {.name = "wood", .base_color = {0.34f, 0.20f, 0.10f}},
                     {.name = "brass", .base_color = {0.55f, 0.40f, 0.16f}}};
  const auto add = [&](const std::string& name, Mesh mesh, PlayroomMaterial material) {
    scene.meshes.push_back({name, std::move(mesh), material});
    return static_cast<int>(scene.meshes.size()) - 1;
  };
  const auto place = [&](Node node) {
    scene.nodes.push_back(std::move(node));
    return static_cast<int>(scene.nodes.size()) - 1;
  };

  const float width = 2 * kRoomHalfWidth;
  place({.name = "floor",
         .mesh = add(
             "floor",
             plane({-kRoomHalfWidth, 0, kRoomFront}, {width, 0, 0}, {0, 0, kRoomBack - kRoomFront}, kCell),
             kFloor)});
  place({.name = "white wall",
         .mesh = add("white wall",
                     plane({-kRoomHalfWidth, 0, kRoomBack}, {width, 0, 0}, {0, kRoomHeight, 0}, kCell),
                     kWhiteWall)});

  constexpr float kBallRadius = 0.32f;
  Node ball{.name = "red ball", .mesh = add("red ball", sphere(kBallRadius, 14), kRedBall)};
  ball.motion = rolling(kBallRadius);
  ball.translation = ball.motion.translations.front();
  ball.rotation = ball.motion.rotations.front();
  place(std::move(ball));

  Node stand{.name = "teapot on its stand",
             .mesh = add("stand", box({-0.28f, 0, -0.28f}, {0.28f, 0.5f, 0.28f}, 0.07f), kWood),
             .translation = {1.0f, 0, -0.25f}};
  stand.movable = true;
  const int stand_node = place(std::move(stand));
  place({.name = "teapot",
         .mesh = add("teapot", teapot(/*cells=*/8, /*height_m=*/0.52f), kTeapotPorcelain),
         .translation = {0, 0.5f, 0},
         .rotation = glm::angleAxis(0.5f, glm::vec3(0, 1, 0)),
         .parent = stand_node});

  Node screen{.name = "screen",
              .mesh = add("screen", box({-0.4f, -0.015f, -0.36f}, {0.4f, 0.015f, 0.36f}, 0.08f), kWood)};
  screen.motion = sliding();
  screen.translation = screen.motion.translations.front();
  place(std::move(screen));

  constexpr float kArm = 0.5f;
  Node lamp{.name = "lamp", .mesh = add("lamp", lampShade(kArm), kBrass), .translation = {0.9f, 2.3f, 1.3f}};
  lamp.motion = swinging(lamp.translation);
  const int lamp_node = place(std::move(lamp));
  scene.spots = {{.name = "bulb",
                  .color = {1.0f, 0.82f, 0.58f},
                  .intensity_cd = 14.0f,
                  .inner_cone_deg = 22.0f,
                  .outer_cone_deg = 42.0f}};
  // It points to the teapot: down and back.
  place({.name = "bulb",
         .mesh = -1,
         .translation = {0, -kArm - 0.12f, 0},
         .rotation = glm::angleAxis(-0.72f, glm::vec3(1, 0, 0)),
         .parent = lamp_node,
         .spot = 0});

  scene.cameras = {{"main", {-0.9f, 1.55f, 4.6f}, {0.1f, 0.72f, -0.5f}, 36.0f},
                   {"detail", {0.1f, 1.25f, 2.2f}, {1.0f, 0.75f, -0.3f}, 36.0f}};
  return scene;
}

}  // namespace lambent::assets
