// The scene `flight` shows neighborhoods and volumes: a flyer with a ring-shaped polished wing circles over
// hills that shadow themselves, and carries its shadow and the light that the ring gathers along; a cloud
// drifts above both.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <glm/common.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>

#include "assets/scenes.hpp"
#include "assets/shapes.hpp"

namespace lambent::assets {

namespace {

// Makes a piece of hilly land to fly over: heights by fractal noise, a mesh, and an image of its colours
// (grass in the valleys, rock where it is steep, snow on the peaks).

constexpr float kSide_m = 40.0f;   // of a square about the origin
constexpr float kHeight_m = 5.0f;  // approximate height of the highest peaks
constexpr float kBowl_m = 11.0f;   // radius of the valley in the middle
constexpr std::uint32_t kSeed = 5, kPeriod = 256;

// Returns ridges that are sharp on top, by folding noise.
float ridged(glm::vec2 at, std::uint32_t seed) {
  float sum = 0.0f, weight = 0.5f, sharper = 1.0f;
  for (std::uint32_t octave = 0; octave < 5; ++octave) {
    const float folded = 1.0f - std::abs(2.0f * noise(at, kPeriod, seed + octave) - 1.0f);
    const float ridge = folded * folded * sharper;
    sum += weight * ridge;
    sharper = std::clamp(1.6f * ridge, 0.0f, 1.0f);
    at = at * 2.03f + 11.7f;
    weight *= 0.5f;
  }
  return sum;
}

// Returns the height at (x, z), all in metres.
float heightAt(float x, float z) {
  const float from_middle = std::sqrt(x * x + z * z) / kBowl_m;
  const float rise = glm::smoothstep(0.55f, 1.6f, from_middle);
  // Lattice coordinates must stay positive.
  const glm::vec2 at = glm::vec2(x, z) / 9.0f + 60.0f;
  const float rolling = noise(at * 1.7f, kPeriod, kSeed + 40) - 0.5f;
  return kHeight_m * (rise * ridged(at, kSeed) * 1.15f + 0.10f * rolling);
}

glm::vec3 normalAt(float x, float z) {
  constexpr float kStep = 0.05f;
  const float along_x = heightAt(x + kStep, z) - heightAt(x - kStep, z);
  const float along_z = heightAt(x, z + kStep) - heightAt(x, z - kStep);
  return glm::normalize(glm::vec3(-along_x, 2.0f * kStep, -along_z));
}

float srgb(float linear) {
  const float c = std::clamp(linear, 0.0f, 1.0f);
  return c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1.0f / 2.4f) - 0.055f;
}

// Makes a mesh of cells x cells cells, with texture coordinates 0..1 over the square.
Mesh terrainMesh(int cells) {
  Mesh mesh = surface(cells, cells, [&](double u, double v) {
    const float x = kSide_m * (static_cast<float>(u) - 0.5f);
    const float z = kSide_m * (0.5f - static_cast<float>(v));
    return SurfacePoint{{x, heightAt(x, z), z}, normalAt(x, z)};
  });
  mesh.texcoords.clear();
  for (const glm::vec3& at : mesh.positions)
    mesh.texcoords.emplace_back(at.x / kSide_m + 0.5f, at.z / kSide_m + 0.5f);
  return mesh;
}

std::vector<std::uint8_t> terrainPng(std::uint32_t side) {
  return squarePng(side, [&](std::uint32_t column, std::uint32_t row) {
    const float u = (static_cast<float>(column) + 0.5f) / static_cast<float>(side);
    const float v = (static_cast<float>(row) + 0.5f) / static_cast<float>(side);
    const float x = kSide_m * (u - 0.5f), z = kSide_m * (v - 0.5f);
    const float level = heightAt(x, z) / kHeight_m;
    const float steep = 1.0f - normalAt(x, z).y;
    const float grain = noise(glm::vec2(column, row) * 0.37f, 4096, kSeed + 90) - 0.5f;
    const glm::vec3 grass(0.17f, 0.26f, 0.075f), rock(0.33f, 0.29f, 0.25f), snow(0.82f, 0.84f, 0.87f);
    glm::vec3 color = glm::mix(grass, glm::vec3(0.30f, 0.30f, 0.12f), std::clamp(3.0f * level, 0.0f, 1.0f));
    color = glm::mix(color, rock, glm::smoothstep(0.10f, 0.26f, steep + 0.08f * grain));
    color = glm::mix(color, snow, glm::smoothstep(0.52f, 0.66f, level + 0.10f * grain - 0.4f * steep));
    color *= 1.0f + 0.25f * grain;
    return glm::vec3(srgb(color.r), srgb(color.g), srgb(color.b));
  });
}

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
  return withoutTexcoords(std::move(mesh));
}

// Makes a band about +Y.
Mesh ringWing(float radius, float width, float thickness) {
  const float low = -0.5f * width, high = 0.5f * width, inner = radius - thickness;
  const std::vector<glm::vec2> profile = {
      {inner, low}, {radius, low}, {radius, high}, {inner, high}, {inner, low}};
  return withoutTexcoords(lathe(profile, 96, width / 4.0f));
}

}  // namespace

Scene flight() {
  Scene scene;
  scene.name = "flight";
  scene.images = {{"land", terrainPng(512)}};
  scene.materials = {{.name = "land", .base_color = glm::vec3(1.0f), .image = 0},
                     {.name = "hull", .base_color = {0.75f, 0.16f, 0.07f}},
                     {.name = "polished ring",
                      .base_color = {0.95f, 0.90f, 0.80f},
                      .double_sided = false,
                      .roughness = 0.05f,
                      .metallic = 1.0f,
                      .specular = 1.0f}};
  scene.meshes = {{"land", terrainMesh(150), kLand}};
  scene.nodes = {{.name = "land", .mesh = 0}};

  constexpr float kCircle = 5.0f, kHeight = 1.35f, kScale = 1.5f;
  Mesh hull = fuselage(3.0f, 0.24f);
  append(hull, spindle({2.1f, 0.035f, 0.30f}), glm::translate(glm::mat4(1.0f), {0.0f, 0.05f, 0.15f}));
  append(hull, spindle({0.62f, 0.025f, 0.17f}), glm::translate(glm::mat4(1.0f), {0.0f, 0.08f, -1.25f}));
  append(hull, spindle({0.025f, 0.36f, 0.20f}), glm::translate(glm::mat4(1.0f), {0.0f, 0.36f, -1.28f}));
  scene.meshes.push_back({"hull", std::move(hull), kHull});
  scene.meshes.push_back({"ring wing", ringWing(0.95f, 0.42f, 0.03f), kPolished});
  Node flyer{.name = "flyer", .mesh = 1};
  setMotion(flyer, leaningCircle(kCircle, kHeight));
  flyer.scale = kScale;
  flyer.neighborhood = Neighborhood{.size = {64, 8, 64}, .extent = {11.0f, 4.4f, 11.0f}};
  scene.nodes.push_back(std::move(flyer));
  scene.nodes.push_back({.name = "ring wing", .mesh = 2, .translation = {0.0f, 0.06f, 0.2f}, .parent = 1});

  Node cloud{.name = "cloud", .mesh = -1};
  setMotion(cloud, drifting({-5.0f, 6.6f, -4.0f}, {5.0f, 6.6f, -4.0f}));
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
