// The scenes of few lines: `hello`, `knot` and `ring` (scenes.hpp).
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
  Mesh floor = plane({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, 0.125f);
  floor.texcoords.clear();
  scene.meshes = {{"floor", std::move(floor), 0},
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
  floor.texcoords.clear();
  // The band has no lower side: it stands on the plane.
  const std::vector<glm::vec2> profile = {
      {kOuter, 0.0f}, {kOuter, kHeight}, {kInner, kHeight}, {kInner, 0.0f}};
  Mesh band = lathe(profile, 192, 0.04f);
  band.texcoords.clear();
  scene.meshes = {{"plane", std::move(floor), 0}, {"ring", std::move(band), 1}};
  scene.nodes = {{"plane", 0}, {"ring", 1}};
  scene.cameras = {{"main", {0.0f, 1.9f, 1.9f}, {0.0f, 0.02f, 0.08f}, 38.0f},
                   {"detail", {0.0f, 1.1f, 0.7f}, {0.0f, 0.0f, -0.12f}, 38.0f}};
  return scene;
}

}  // namespace lambent::assets
