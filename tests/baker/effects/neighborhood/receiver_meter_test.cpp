// Tests how strongly receivers see a change, depending on their normals.
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "baker/effects/neighborhood/neighborhood.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::baker {
namespace {

// Returns V - 1 of a small black body in one direction.
std::vector<float> blackIn(const glm::vec3& direction, const ChangeShape& shape, float steradians) {
  std::vector<float> visibility(shape.visibilitySize());
  sh::evaluate(shape.visibilityBands(), direction, visibility);
  for (float& v : visibility) v *= -steradians;
  return visibility;
}

FacingArea facing(const glm::vec3& normal) {
  FacingArea area{};
  addFacing(area, normal, 3.0f);
  return area;
}

TEST(ReceiverMeter, OfReceiversThatFaceAnywhereIsTheChangeMeter) {
  for (const int outputs : {3, 5}) {
    const ChangeShape shape{.order = 5, .order_out = outputs, .channels = 0};
    FacingArea anywhere{};
    addFacingAnywhere(anywhere, 5.0f);
    const auto change = blackIn(glm::normalize(glm::vec3(1, 2, -1)), shape, 0.2f);
    const double measured = ReceiverMeter(shape, anywhere).measure(change, {});
    EXPECT_DOUBLE_EQ(measured, ReceiverMeter(shape, {}).measure(change, {}));
    // ChangeMeter also weights a fifth band, or all bands.
    if (outputs == 3) {
      EXPECT_NEAR(measured / ChangeMeter(shape).measure(change, {}), 1.0, 0.02);
    }
  }
}

TEST(ReceiverMeter, FallsWithTheCosine) {
  const ChangeShape shape{.order = 5, .order_out = 3, .channels = 0};
  const ReceiverMeter floor(shape, facing({0, 1, 0}));
  const auto seen = [&](float height) {
    return floor.measure(blackIn(glm::normalize(glm::vec3(1.0f, height, 0.0f)), shape, 0.1f), {});
  };
  EXPECT_GT(seen(1.0f), 2.0 * seen(0.2f));
  // The weight has three bands of the clamped cosine: it is not quite 0 for a body on the horizon or below.
  EXPECT_LT(seen(0.0f), 0.2 * seen(1.0f));
  EXPECT_LT(seen(-1.0f), 0.1 * seen(1.0f));
  // Light that the body emits counts the same.
  const ChangeShape sends{.order = 5, .order_out = 3, .channels = 1};
  std::vector<float> bounced(sends.bouncedSize(), 0.0f);
  std::vector<float> y(9);
  sh::evaluate(3, glm::vec3(0, 1, 0), std::span<float>(y));
  for (std::size_t i = 0; i < 9; ++i) bounced[i * sends.columns()] = 0.1f * y[i];
  const std::vector<float> open(sends.visibilitySize(), 0.0f);
  EXPECT_GT(ReceiverMeter(sends, facing({0, 1, 0})).measure(open, bounced),
            10.0 * ReceiverMeter(sends, facing({0, -1, 0})).measure(open, bounced));
}

}  // namespace
}  // namespace lambent::baker
