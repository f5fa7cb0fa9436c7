// The scene `ring` shows a caustic: a polished ring of gold that stands on a white plane and gathers light in
// it, as in the talk on precomputed radiance transfer (Sloan, Kautz and Snyder 2002). The plane's vertices
// are as many as the texels of the talk's plane.
#include <vector>

#include "assets/scenes.hpp"
#include "assets/shapes.hpp"

namespace lambent::assets {

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
