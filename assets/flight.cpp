// The scene `flight` shows neighborhoods and volumes: a flyer with a ring-shaped polished wing circles over
// hills that shadow themselves, and carries its shadow and the light that the ring gathers along; a cloud
// drifts above both.
#include <cmath>
#include <numbers>

#include <glm/ext/matrix_transform.hpp>

#include "assets/scenes.hpp"
#include "assets/shapes.hpp"
#include "assets/terrain.hpp"

namespace lambent::assets {

namespace {

enum FlightMaterial { kLand, kHull, kPolished };

// Moves once around in ten seconds, leaning into the turn; the nose is +Z.
Motion leaningCircle(float radius, float height) {
  Motion motion;
  constexpr int kKeys = 40;
  constexpr float kLean = 0.16f, kSeconds = 10.0f;
  for (int i = 0; i <= kKeys; ++i) {
    const float phase = static_cast<float>(i) / kKeys;
    const float angle = 2.0f * std::numbers::pi_v<float> * phase;
    motion.times_s.push_back(kSeconds * phase);
    motion.translations.emplace_back(radius * std::cos(angle), height + 0.25f * std::sin(2.0f * angle),
                                     -radius * std::sin(angle));
    motion.rotations.push_back(glm::angleAxis(angle + std::numbers::pi_v<float>, glm::vec3(0, 1, 0)) *
                               glm::angleAxis(-kLean, glm::vec3(0, 0, 1)));
  }
  return motion;
}

// Moves there and back in forty seconds.
Motion drifting(glm::vec3 from, glm::vec3 to) {
  Motion motion;
  motion.times_s = {0.0f, 20.0f, 40.0f};
  for (const glm::vec3& place : {from, to, from}) motion.translations.push_back(place);
  return motion;
}

// Makes a body of revolution along +Z, pointed at both ends.
Mesh fuselage(float length, float radius) {
  return surface(28, 24, [&](double u, double v) {
    const double along = std::numbers::pi_v<float> * v, around = 2.0 * std::numbers::pi_v<float> * u;
    const glm::vec3 unit(static_cast<float>(std::sin(along) * std::cos(around)),
                         static_cast<float>(std::sin(along) * std::sin(around)),
                         static_cast<float>(-std::cos(along)));
    const glm::vec3 axes(radius, radius, 0.5f * length);
    return SurfacePoint{unit * axes, glm::normalize(unit / axes)};
  });
}

// Makes a flat spindle for wings and fins. `axes` are its half sizes.
Mesh spindle(glm::vec3 axes) {
  Mesh mesh = sphere(1.0f, 10);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    mesh.positions[i] *= axes;
    mesh.normals[i] = glm::normalize(mesh.normals[i] / axes);
  }
  mesh.texcoords.clear();
  return mesh;
}

// Makes a band about +Y.
Mesh ringWing(float radius, float width, float thickness) {
  const float low = -0.5f * width, high = 0.5f * width, inner = radius - thickness;
  const std::vector<glm::vec2> profile = {
      {inner, low}, {radius, low}, {radius, high}, {inner, high}, {inner, low}};
  Mesh mesh = lathe(profile, 96, width / 4.0f);
  mesh.texcoords.clear();
  return mesh;
}

}  // namespace

Scene flight() {
  Scene scene;
  scene.name = "flight";
  const Terrain terrain;
  scene.images = {{"land", terrainPng(terrain, 512)}};
  scene.materials = {{.name = "land", .base_color = glm::vec3(1.0f), .image = 0},
                     {.name = "hull", .base_color = {0.75f, 0.16f, 0.07f}},
                     {.name = "polished ring",
                      .base_color = {0.95f, 0.90f, 0.80f},
                      .double_sided = false,
                      .roughness = 0.05f,
                      .metallic = 1.0f,
                      .specular = 1.0f}};
  scene.meshes = {{"land", terrainMesh(terrain, 150), kLand}};
  scene.nodes = {{.name = "land", .mesh = 0}};

  constexpr float kCircle = 5.0f, kHeight = 1.35f, kScale = 1.5f;
  Mesh hull = fuselage(3.0f, 0.24f);
  append(hull, spindle({2.1f, 0.035f, 0.30f}), glm::translate(glm::mat4(1.0f), {0.0f, 0.05f, 0.15f}));
  append(hull, spindle({0.62f, 0.025f, 0.17f}), glm::translate(glm::mat4(1.0f), {0.0f, 0.08f, -1.25f}));
  append(hull, spindle({0.025f, 0.36f, 0.20f}), glm::translate(glm::mat4(1.0f), {0.0f, 0.36f, -1.28f}));
  scene.meshes.push_back({"hull", std::move(hull), kHull});
  scene.meshes.push_back({"ring wing", ringWing(0.95f, 0.42f, 0.03f), kPolished});
  Node flyer{.name = "flyer", .mesh = 1};
  flyer.motion = leaningCircle(kCircle, kHeight);
  flyer.translation = flyer.motion.translations.front();
  flyer.rotation = flyer.motion.rotations.front();
  flyer.scale = kScale;
  flyer.neighborhood = Neighborhood{.size = {64, 8, 64}, .extent = {11.0f, 4.4f, 11.0f}};
  scene.nodes.push_back(std::move(flyer));
  scene.nodes.push_back({.name = "ring wing", .mesh = 2, .translation = {0.0f, 0.06f, 0.2f}, .parent = 1});

  Node cloud{.name = "cloud", .mesh = -1};
  cloud.motion = drifting({-5.0f, 6.6f, -4.0f}, {5.0f, 6.6f, -4.0f});
  cloud.translation = cloud.motion.translations.front();
  cloud.volume = Volume{.file = "procedural:cloud,7",
                        .density_scale = 3.0f,
                        .albedo = glm::vec3(0.99f),
                        .size = {9.0f, 3.6f, 7.0f}};
  scene.nodes.push_back(std::move(cloud));

  scene.cameras = {{"main", {2.5f, 8.5f, 16.5f}, {0.0f, 2.2f, -2.5f}, 44.0f},
                   {"detail", {6.5f, 5.2f, 8.5f}, {2.5f, 0.8f, 0.0f}, 40.0f}};
  return scene;
}

}  // namespace lambent::assets
