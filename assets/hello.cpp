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

}  // namespace lambent::assets
