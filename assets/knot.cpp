#include "assets/scenes.hpp"
#include "assets/torus_knot.hpp"

namespace lambent::assets {

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

}  // namespace lambent::assets
