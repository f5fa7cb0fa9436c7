// Tests what bodies that are left out of captures hide of lamps that are shaded per pixel.
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/light_plan/light_plan.hpp"

namespace lambent::frame {
namespace {

// A wall of two metres at x = 1, with a light probe 2 m before it and another one above, and a small lamp
// 2 m behind it.
struct Walled {
  Walled() {
    wall.positions = {{1, -1, -1}, {1, 1, -1}, {1, 1, 1}, {1, -1, 1}};
    wall.triangles.resize(2);
    wall.triangles[0].vertices = {0, 1, 2};
    wall.triangles[1].vertices = {0, 2, 3};
    wall.levels = {{.first_triangle = 0, .triangle_count = 2}};
    scene.lights = {{.position_ws = {3, 0, 0}, .power = glm::vec3(1.0f)}};
    scene.bodies = {{.body = {.proxy = 0, .world_from_proxy = glm::mat4(1.0f)},
                     .center_ws = {1, 0, 0},
                     .radius_m = 1.5f,
                     .key = 7}};
    scene.groups = {
        {.samples_ws = {{-1, 0, 0}, {-1, 5, 0}}, .carriers = {{.per_pixel = 1.0f}}, .left_out = {0}}};
  }
  std::size_t update() { return occlusion.update(scene, std::array{&std::as_const(wall)}, version); }
  const std::vector<float>& open() const { return scene.groups[0].open; }

  bundle::CaptureProxy wall;
  LightPlan scene;
  ApartOcclusion occlusion;
  std::uint64_t version = 1;
};

TEST(ApartOcclusion, HidesTheLampBehindAWallOnly) {
  Walled walled;
  walled.update();
  EXPECT_EQ(walled.open(), (std::vector<float>{0.0f, 1.0f}));
}

TEST(ApartOcclusion, TracesNothingWhileNothingMovesAndAnewWhereAnythingDoes) {
  Walled walled;
  EXPECT_EQ(walled.update(), 2u);
  walled.scene.groups[0].open.clear();
  EXPECT_EQ(walled.update(), 0u);
  EXPECT_EQ(walled.open(), (std::vector<float>{0.0f, 1.0f}));

  walled.scene.lights[0].power = glm::vec3(2.0f);
  EXPECT_EQ(walled.update(), 0u);
  walled.scene.lights[0].position_ws = {3, 0, 8};
  EXPECT_EQ(walled.update(), 2u);
  EXPECT_EQ(walled.open()[0], 1.0f);
  walled.scene.bodies[0].body.world_from_proxy[3] = {0, 0, 4, 1};
  walled.scene.bodies[0].center_ws.z = 4.0f;
  EXPECT_EQ(walled.update(), 2u);
  EXPECT_EQ(walled.open(), (std::vector<float>{0.0f, 1.0f}));
  ++walled.version;
  EXPECT_EQ(walled.update(), 2u);
  walled.scene.groups[0].carriers = {{}};
  EXPECT_EQ(walled.update(), 0u);
  EXPECT_TRUE(walled.open().empty());
}

}  // namespace
}  // namespace lambent::frame
