// The scene `metals` shows glossy transfer: metals that reflect each other and the room, from polished to
// rough, brushed and glazed ones, and a white wall that receives their light.
#include <numbers>
#include <vector>

#include "assets/scenes.hpp"
#include "assets/shapes.hpp"
#include "assets/teapot.hpp"

namespace lambent::assets {

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
  const auto add = [&](const std::string& name, Mesh mesh, int material) {
    scene.meshes.push_back({name, std::move(mesh), material});
    return static_cast<int>(scene.meshes.size()) - 1;
  };
  const auto place = [&](const std::string& name, int mesh, glm::vec3 at, float turn_deg = 0.0f,
                         float scale = 1.0f) {
    const float half = turn_deg * std::numbers::pi_v<float> / 360.0f;
    scene.nodes.push_back({name, mesh, at, glm::quat(std::cos(half), 0.0f, std::sin(half), 0.0f), scale});
  };
  const auto without = [](Mesh mesh) {
    mesh.texcoords.clear();
    return mesh;
  };

  place("table", add("table", plane({-2.2f, 0, 1.4f}, {4.4f, 0, 0}, {0, 0, -2.8f}, 0.05f), kTable), {});
  place("wall", add("wall", without(plane({-2.2f, 0, -1.4f}, {4.4f, 0, 0}, {0, 1.8f, 0}, 0.05f)), kBackWall),
        {});
  place("teapot", add("teapot", without(teapot(/*cells=*/18, /*height_m=*/0.8f)), kGold), {0.05f, 0, -0.45f},
        20.0f);
  place("bowl", add("bowl", turnedBowl(), kSteel), {1.22f, 0, -0.25f});
  place("knot",
        add("knot",
            without(torusKnot({.ring_radius = 0.30f,
                               .torus_radius = 0.13f,
                               .tube_radius = 0.07f,
                               .cells_along = 260,
                               .cells_around = 24})),
            kGlaze),
        {-1.22f, 0.21f, -0.35f});
  for (std::size_t i = 0; i < std::size(kRoughnesses); ++i)
    place("copper ball",
          add("copper ball", without(sphere(/*radius=*/0.2f, /*cells=*/16)),
              kFirstCopper + static_cast<int>(i)),
          {-0.85f + 0.5f * static_cast<float>(i), 0.2f, 0.62f});
  place("rubber ball", add("rubber ball", without(sphere(/*radius=*/0.16f, /*cells=*/12)), kRubber),
        {1.2f, 0.16f, 0.66f});

  scene.cameras = {{"main", {0.35f, 1.35f, 3.3f}, {0.0f, 0.32f, -0.1f}, 38.0f},
                   {"detail", {0.9f, 0.75f, 1.5f}, {0.1f, 0.3f, -0.2f}, 36.0f}};
  return scene;
}

}  // namespace lambent::assets
