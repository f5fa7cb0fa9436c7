#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <glm/common.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec2.hpp>

#include "assets/scenes.hpp"
#include "assets/shapes.hpp"

namespace lambent::assets {

std::vector<std::uint8_t> stonePng(int tiles, int texels_per_tile) {
  const auto side = static_cast<std::uint32_t>(tiles * texels_per_tile);
  return squarePng(side, [&](std::uint32_t x, std::uint32_t y) {
    const auto per_tile = static_cast<std::uint32_t>(texels_per_tile);
    const std::uint32_t tile_x = x / per_tile, tile_y = y / per_tile;
    const float in_x = static_cast<float>(x % per_tile) + 0.5f,
                in_y = static_cast<float>(y % per_tile) + 0.5f;
    const float edge = static_cast<float>(texels_per_tile);
    const float to_joint = std::min({in_x, in_y, edge - in_x, edge - in_y});
    float grain = 0.0f;
    for (std::uint32_t octave = 0; octave < 5; ++octave) {
      const std::uint32_t period = static_cast<std::uint32_t>(tiles) * (2u << octave);
      const glm::vec2 at = glm::vec2(x, y) * (static_cast<float>(period) / static_cast<float>(side));
      grain += (noise(at, period, octave) - 0.5f) / static_cast<float>(1u << (octave / 2));
    }
    const glm::vec3 tone =
        (tile_x + tile_y) % 2 ? glm::vec3(0.80f, 0.74f, 0.65f) : glm::vec3(0.62f, 0.54f, 0.46f);
    const float own = 1.0f + 0.08f * (hash(tile_x, tile_y, 99) - 0.5f) + 0.07f * grain;
    const float joint = glm::mix(0.62f, 1.0f, glm::smoothstep(1.0f, 2.5f, to_joint));
    return glm::clamp(tone * own * joint, 0.0f, 1.0f);
  });
}

namespace {

// The room has inner faces at x = +-kGalleryHalfWidth and z = kGalleryBack, and is open at z = kGalleryFront
// and above kGalleryHeight.
constexpr float kGalleryHalfWidth = 2.5f, kGalleryBack = -2.2f, kGalleryFront = 2.4f, kGalleryHeight = 2.6f,
                kThick = 0.14f;
constexpr float kFine = 0.045f, kCoarse = 0.4f;  // cell sizes in metres: where light falls, and out of sight

enum GalleryMaterial { kStone, kRedWall, kTeal, kPlaster, kLimestone, kPorcelain, kBronze, kCobalt, kOchre };

std::vector<Material> galleryMaterials() {
  return {{.name = "stone floor", .base_color = glm::vec3(1.0f), .image = 0},
          {.name = "red wall", .base_color = {0.56f, 0.10f, 0.07f}},
          {.name = "teal wall", .base_color = {0.07f, 0.33f, 0.36f}},
          {.name = "plaster", .base_color = {0.40f, 0.37f, 0.33f}},
          {.name = "limestone", .base_color = {0.70f, 0.65f, 0.57f}},
          // The inside shows through the spout and the gap under the lid.
          {.name = "porcelain", .base_color = {0.82f, 0.81f, 0.78f}, .double_sided = true},
          {.name = "bronze", .base_color = {0.72f, 0.42f, 0.14f}},
          {.name = "cobalt", .base_color = {0.09f, 0.16f, 0.48f}},
          {.name = "ochre", .base_color = {0.80f, 0.55f, 0.16f}}};
}

// Makes a slab of which one face (edge_u x edge_v) has fine cells; the others close it coarsely.
Mesh slab(glm::vec3 corner, glm::vec3 edge_u, glm::vec3 edge_v, glm::vec3 depth, float cell) {
  Mesh mesh = plane(corner, edge_u, edge_v, cell);
  append(mesh, plane(corner + depth + edge_u, -edge_u, edge_v, kCoarse));
  append(mesh, plane(corner + edge_u, depth, edge_v, kCoarse));
  append(mesh, plane(corner + depth, -depth, edge_v, kCoarse));
  append(mesh, plane(corner + edge_v, edge_u, depth, kCoarse));
  append(mesh, plane(corner + depth, edge_u, -depth, kCoarse));
  return mesh;
}

// Texture coordinates count metres; one repeat of the texture is two tiles wide.
Mesh tiledFloor() {
  constexpr float kTile = 0.5f;
  const float width = 2 * (kGalleryHalfWidth + kThick), length = kGalleryFront - kGalleryBack + kThick;
  Mesh mesh = slab({-kGalleryHalfWidth - kThick, 0, kGalleryFront}, {width, 0, 0}, {0, 0, -length},
                   {0, -kThick, 0}, kFine);
  for (glm::vec2& texcoord : mesh.texcoords) texcoord /= 2 * kTile;
  return mesh;
}

Mesh column() {
  constexpr std::array<glm::vec2, 14> kProfile = {{{0.0f, 0.0f},
                                                   {0.34f, 0.0f},
                                                   {0.34f, 0.07f},
                                                   {0.29f, 0.10f},
                                                   {0.29f, 0.14f},
                                                   {0.23f, 0.18f},
                                                   {0.21f, 0.50f},
                                                   {0.21f, 0.72f},
                                                   {0.24f, 0.76f},
                                                   {0.24f, 0.79f},
                                                   {0.40f, 0.83f},
                                                   {0.42f, 0.83f},
                                                   {0.42f, 0.90f},
                                                   {0.0f, 0.90f}}};
  return lathe(kProfile, 96, 0.03f);
}

}  // namespace

Scene gallery() {
  Scene scene;
  scene.name = "gallery";
  scene.materials = galleryMaterials();
  scene.images = {{"stone", stonePng(/*tiles=*/2, /*texels_per_tile=*/128)}};

  const float depth = kGalleryFront - kGalleryBack;
  show(scene, "floor", tiledFloor(), kStone);
  show(scene, "back wall",
       withoutTexcoords(slab({-kGalleryHalfWidth, 0, kGalleryBack}, {2 * kGalleryHalfWidth, 0, 0},
                             {0, kGalleryHeight, 0}, {0, 0, -kThick}, kFine)),
       kPlaster);
  show(scene, "left wall",
       withoutTexcoords(slab({-kGalleryHalfWidth, 0, kGalleryFront}, {0, 0, -depth}, {0, kGalleryHeight, 0},
                             {-kThick, 0, 0}, kFine)),
       kRedWall);
  show(scene, "right wall",
       withoutTexcoords(slab({kGalleryHalfWidth, 0, kGalleryBack}, {0, 0, depth}, {0, kGalleryHeight, 0},
                             {kThick, 0, 0}, kFine)),
       kTeal);

  show(scene, "column", column(), kLimestone);
  show(scene, "teapot", teapot(/*cells=*/22, /*height_m=*/0.74f), kPorcelain, {0, 0.90f, 0}, 24.0f);

  const int plinth =
      addMesh(scene, "plinth", box({-0.42f, 0, -0.42f}, {0.42f, 0.46f, 0.42f}, 0.04f), kLimestone);
  place(scene, "plinth of the knot", plinth, {1.46f, 0, -1.05f}, -18.0f);
  place(scene, "plinth of the spheres", plinth, {-1.50f, 0, -1.15f}, 14.0f);

  // The knot's own axis is vertical; here it stands upright on its plinth and faces the room.
  const int knot = addMesh(scene, "torus knot",
                           torusKnot({.ring_radius = 0.36f,
                                      .torus_radius = 0.16f,
                                      .tube_radius = 0.085f,
                                      .cells_along = 420,
                                      .cells_around = 36}),
                           kBronze);
  const glm::quat upright = glm::angleAxis(-0.35f, glm::vec3(0, 1, 0)) *
                            glm::angleAxis(std::numbers::pi_v<float> / 2, glm::vec3(1, 0, 0));
  scene.nodes.push_back({"torus knot", knot, {1.46f, 1.03f, -1.05f}, upright, 1.0f});

  const int ball = addMesh(scene, "ball", sphere(/*radius=*/1.0f, /*cells=*/24), kCobalt);
  place(scene, "large ball", ball, {-1.50f, 0.80f, -1.15f}, 0.0f, 0.34f);
  place(scene, "small ball", ball, {-0.98f, 0.15f, 0.62f}, 0.0f, 0.15f);

  show(scene, "cube", box({-0.16f, 0, -0.16f}, {0.16f, 0.32f, 0.16f}, 0.025f), kOchre, {1.12f, 0, 0.55f},
       31.0f);

  scene.cameras = {{"main", {0.65f, 1.72f, 4.9f}, {0.02f, 0.93f, -0.3f}, 35.0f},
                   {"detail", {-0.75f, 1.75f, 1.9f}, {0.1f, 1.13f, -0.1f}, 34.0f}};
  return scene;
}

// The scene `playroom` shows moving light: a ball that tints the wall it rolls along, a lamp that swings, and
// a screen that keeps its light from the teapot.

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
    return addMesh(scene, name, std::move(mesh), material);
  };
  const auto placed = [&](Node node) {
    scene.nodes.push_back(std::move(node));
    return static_cast<int>(scene.nodes.size()) - 1;
  };

  const float width = 2 * kRoomHalfWidth;
  show(scene, "floor",
       plane({-kRoomHalfWidth, 0, kRoomFront}, {width, 0, 0}, {0, 0, kRoomBack - kRoomFront}, kCell), kFloor);
  show(scene, "white wall", plane({-kRoomHalfWidth, 0, kRoomBack}, {width, 0, 0}, {0, kRoomHeight, 0}, kCell),
       kWhiteWall);

  constexpr float kBallRadius = 0.32f;
  Node ball{.name = "red ball", .mesh = add("red ball", sphere(kBallRadius, 14), kRedBall)};
  setMotion(ball, rolling(kBallRadius));
  placed(std::move(ball));

  Node stand{.name = "teapot on its stand",
             .mesh = add("stand", box({-0.28f, 0, -0.28f}, {0.28f, 0.5f, 0.28f}, 0.07f), kWood),
             .translation = {1.0f, 0, -0.25f}};
  stand.movable = true;
  const int stand_node = placed(std::move(stand));
  placed({.name = "teapot",
          .mesh = add("teapot", teapot(/*cells=*/8, /*height_m=*/0.52f), kTeapotPorcelain),
          .translation = {0, 0.5f, 0},
          .rotation = glm::angleAxis(0.5f, glm::vec3(0, 1, 0)),
          .parent = stand_node});

  Node screen{.name = "screen",
              .mesh = add("screen", box({-0.4f, -0.015f, -0.36f}, {0.4f, 0.015f, 0.36f}, 0.08f), kWood)};
  setMotion(screen, sliding());
  placed(std::move(screen));

  constexpr float kArm = 0.5f;
  Node lamp{.name = "lamp", .mesh = add("lamp", lampShade(kArm), kBrass), .translation = {0.9f, 2.3f, 1.3f}};
  lamp.motion = swinging(lamp.translation);
  const int lamp_node = placed(std::move(lamp));
  scene.spots = {{.name = "bulb",
                  .color = {1.0f, 0.82f, 0.58f},
                  .intensity_cd = 14.0f,
                  .inner_cone_deg = 22.0f,
                  .outer_cone_deg = 42.0f}};
  // It points to the teapot: down and back.
  placed({.name = "bulb",
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
