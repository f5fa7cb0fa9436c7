// Tests what a few rays say of groups whose light is known in closed form.
#include "baker/decisions/group_look.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "baker/compress/light_weights.hpp"
#include "tests/support/shapes.hpp"

namespace lambent::baker {
namespace {

using testing::box;
using testing::flipped;
using testing::grid;
using testing::icosphere;
using testing::sceneOf;

GroupLook look(const Scene& scene) {
  DecodedImages images(scene);
  const auto looked = lookAt(scene, findRigidGroups(scene), {}, images);
  EXPECT_TRUE(looked) << looked.error().line();
  return looked ? looked->at(0) : GroupLook{};
}

TEST(GroupLook, FindsThatAConvexBodySeesAllOfItsSky) {
  const GroupLook seen = look(sceneOf({icosphere({0, 0, 0}, 1.0f, 3)}));
  EXPECT_NEAR(seen.all.hidden, 0.0, 1e-5);
  EXPECT_NEAR(seen.passes.at(0), 1.0, 1e-5);
  EXPECT_NEAR(seen.all.area, 4.0 * std::numbers::pi, 0.1);
}

// In a closed room of albedo ρ light that surfaces give off arrives with shares (1 - ρ) ρ^b.
TEST(GroupLook, FollowsLightInAClosedRoomAsItsAlbedoSays) {
  Scene room = sceneOf({flipped(box({0, 0, 0}, {1, 1, 1}, 2))});
  for (const double albedo : {0.3, 0.7}) {
    room.materials[0].base_color = glm::vec4(glm::vec3(static_cast<float>(albedo)), 1.0f);
    room.materials[0].specular = 0.0f;
    const GroupLook seen = look(room);
    EXPECT_NEAR(seen.all.hidden, 1.0, 1e-5);
    for (const std::size_t bounces : {0u, 1u, 3u})
      EXPECT_NEAR(seen.after(bounces), std::pow(albedo, static_cast<double>(bounces + 1)), 0.01);
  }
}

TEST(GroupLook, SeesNothingBounceFromBlackSurfaces) {
  Scene scene = sceneOf({grid({0, 0, 0}, 2.0f, 2), box({0, 0.3f, 0}, {0.5f, 0.5f, 0.5f}, 1)});
  scene.materials[0].base_color = glm::vec4(0, 0, 0, 1);
  scene.materials[0].specular = 0.0f;
  const GroupLook seen = look(scene);
  EXPECT_GT(seen.all.hidden, 0.02);
  EXPECT_EQ(seen.after(0), 0.0);
}

// A square of side 1 straight above the middle of another at distance 1 hides, as seen from all of its
// points, the share of two parallel squares: 0.1998 (Howell, configuration C-11).
TEST(GroupLook, HidesTheShareOfTwoParallelSquares) {
  const GroupLook seen = look(sceneOf({grid({0, 0, 0}, 1.0f, 1), flipped(grid({0, 1, 0}, 1.0f, 1))}));
  EXPECT_NEAR(seen.all.hidden, 0.1998, 0.004);
  EXPECT_NEAR(seen.draws.at(1).hidden, 0.1998, 0.006);
}

// An open plane's transfer is A_l/pi y_l(n), with power (A_l/pi)² (2l+1)/4pi in band l.
TEST(GroupLook, TellsTheBandsOfAnOpenPlane) {
  const std::array<double, 8> zonal = {1.0, 2.0 / 3.0, 0.25, 0.0, -1.0 / 24.0, 0.0, 1.0 / 64.0, 0.0};
  double all = 0.0, from_three = 0.0;
  for (std::size_t l = 0; l < zonal.size(); ++l) {
    const double power = kBandPower[l] * zonal[l] * zonal[l] * static_cast<double>(2 * l + 1);
    all += power;
    if (l >= 3) from_three += power;
  }
  const GroupLook seen = look(sceneOf({grid({0, 0, 0}, 2.0f, 1)}));
  EXPECT_NEAR(seen.from_band.at(0), 1.0, 1e-9);
  EXPECT_NEAR(seen.from_band.at(3), std::sqrt(from_three / all), 0.003);
}

}  // namespace
}  // namespace lambent::baker
