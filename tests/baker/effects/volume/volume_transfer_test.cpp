// Transfer of volumes against closed forms (literature 7.8) and what must hold whatever the numbers.
#include <array>
#include <bit>
#include <chrono>
#include <numbers>

#include <gtest/gtest.h>

#include "baker/work/parallel.hpp"
#include "tests/baker/effects/volume/media.hpp"

namespace lambent::baker {
namespace {

using testing::cube;
using testing::Fog;
using testing::transferOf;
using testing::uniformAt;

constexpr glm::dvec3 kCenter(0.0);

VolumeSettings gridOf(std::uint32_t n, int order = 5) {
  VolumeSettings settings;
  settings.grid = glm::uvec3(n);
  settings.order = order;
  settings.rays = 512;
  return settings;
}

TEST(VolumeTransfer, OfTheCubesCentreIsTheMeanTransmittance) {
  for (const auto& [sigma, wanted] : {std::pair{1.0f, 0.5445496}, {4.0f, 0.0908467}, {16.0f, 0.0001013}}) {
    const VolumeTransfer t = transferOf(cube(sigma), gridOf(5));  // odd: a voxel in the middle
    EXPECT_NEAR(uniformAt(t, kCenter, 0) / wanted, 1.0, 2e-3) << sigma;
  }
}

TEST(VolumeTransfer, OfAMediumThatAbsorbsNothingIsOneEverywhereInUniformLight) {
  for (const float sigma : {1.0f, 4.0f, 16.0f}) {
    const VolumeTransfer t = transferOf(cube(sigma), gridOf(12, 1));
    ASSERT_EQ(t.grid.samples(), 12u * 12u * 12u);
    double worst = 0.0;
    for (std::size_t p = 0; p < t.grid.samples(); ++p)
      worst = std::max(worst, std::abs(double{t.vectors[2 * p + 1]} * std::sqrt(4.0 * std::numbers::pi) - 1.0));
    EXPECT_LT(worst, 5e-3) << sigma;
    std::printf("furnace sigma %g worst %g iterations %d residual %g row bytes %lu\n", double(sigma), worst, t.iterations, t.residual, t.row_bytes);
  }
}

TEST(VolumeTransfer, OfTheCubesCentreWithAllScatteringsIsThatOfRandomWalks) {
  struct Case {
    float sigma, albedo;
    double wanted;
  };
  for (const Case& c : {Case{1, 0.5f, 0.716}, Case{1, 0.9f, 0.930}, Case{4, 0.5f, 0.210}, Case{4, 0.9f, 0.651},
                        Case{16, 0.9f, 0.052}}) {
    const VolumeTransfer t = transferOf(cube(c.sigma), gridOf(17, 1), glm::vec3(c.albedo));
    const VolumeTransfer t2 = transferOf(cube(c.sigma), gridOf(9,1), glm::vec3(c.albedo));
    EXPECT_NEAR(uniformAt(t, kCenter, 1), c.wanted, 0.003) << c.sigma << " " << c.albedo;
    std::printf("sigma %g w %g: %g %g wanted %g it %d\n", double(c.sigma), double(c.albedo), uniformAt(t, kCenter, 1),uniformAt(t2, kCenter, 1), c.wanted, t.iterations);
  }
}

}  // namespace
}  // namespace lambent::baker
