// Tests that grid points hold the values that interpolate best.
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "baker/effects/neighborhood/grid_placement.hpp"

namespace lambent::baker {
namespace {

constexpr GridPlacement kGrid{.size = {9, 7, 6}, .box = {{0, 0, 0}, {8, 6, 5}}};

double waves(const glm::vec3& p) {
  return std::cos(0.8 * double{p.x} + 0.3) * std::cos(0.6 * double{p.y} - 0.2) +
         std::sin(0.7 * double{p.z} + 0.5 * double{p.x});
}

template <typename Field>
std::vector<float> sampled(const Field& field) {
  std::vector<float> values;
  for (std::size_t p = 0; p < kGrid.count(); ++p) values.push_back(static_cast<float>(field(kGrid.point(p))));
  return values;
}

// Returns the RMS error of trilinear interpolation, at least a cell away from the faces.
double errorOf(const std::vector<float>& values) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform;
  double square = 0.0;
  constexpr int kPlaces = 2000;
  for (int n = 0; n < kPlaces; ++n) {
    const glm::vec3 at =
        1.0f + glm::vec3(uniform(random), uniform(random), uniform(random)) * glm::vec3(6.0f, 4.0f, 3.0f);
    const glm::uvec3 first(at);
    const glm::vec3 part = at - glm::vec3(first);
    double sum = 0.0;
    for (unsigned corner = 0; corner < 8; ++corner) {
      double weight = 1.0;
      for (int axis = 0; axis < 3; ++axis)
        weight *= double{(corner >> axis & 1u) != 0 ? part[axis] : 1.0f - part[axis]};
      const glm::uvec3 q = first + glm::uvec3(corner & 1u, corner >> 1 & 1u, corner >> 2);
      sum += weight * double{values[q.x + kGrid.size.x * (q.y + std::size_t{kGrid.size.y} * q.z)]};
    }
    square += std::pow(sum - waves(at), 2);
  }
  return std::sqrt(square / kPlaces);
}

const std::vector<std::uint8_t> kAllOutside(kGrid.count(), 1);

TEST(FitBetweenPoints, HalvesTheErrorOfInterpolatingACurvedField) {
  std::vector<float> values = sampled(waves);
  const double before = errorOf(values);
  fitBetweenPoints(kGrid, kAllOutside, 1, values);
  EXPECT_GT(before, 0.02);
  EXPECT_LT(errorOf(values), 0.5 * before);
}

TEST(FitBetweenPoints, LeavesWhatIsLinearAsItIs) {
  const auto linear = [](const glm::vec3& p) { return 1.0f + 2.0f * p.x - 3.0f * p.y + 0.5f * p.z; };
  std::vector<float> values = sampled(linear);
  const std::vector<float> before = values;
  fitBetweenPoints(kGrid, kAllOutside, 1, values);
  for (std::size_t p = 0; p < values.size(); ++p) EXPECT_NEAR(values[p], before[p], 1e-4f) << p;
}

TEST(FitBetweenPoints, ChangesNothingBesideTheBodyNorAlongAxesWhoseLayersReceiversStandOn) {
  const std::vector<float> before = sampled(waves);
  std::vector<std::uint8_t> outside = kAllOutside;
  const std::size_t body = 4 + 9 * (3 + 7 * 2);  // (4, 3, 2)
  outside[body] = 0;
  GridPlacement flat = kGrid;
  flat.on_layer = {false, true, true};
  std::vector<float> values = before;
  fitBetweenPoints(flat, outside, 1, values);
  for (std::size_t p = 0; p < values.size(); ++p) {
    const bool face = p % 9 == 0 || p % 9 == 8, beside = p + 1 >= body && p <= body + 1;
    EXPECT_EQ(values[p] == before[p], face || beside) << p;
  }
}

TEST(FitBetweenPoints, KeepsTheValuesOfAPointApart) {
  std::vector<float> one = sampled(waves), two;
  for (const float value : one) two.insert(two.end(), {value, -2.0f * value});
  fitBetweenPoints(kGrid, kAllOutside, 1, one);
  fitBetweenPoints(kGrid, kAllOutside, 2, two);
  for (std::size_t p = 0; p < one.size(); ++p) {
    EXPECT_FLOAT_EQ(two[2 * p], one[p]);
    EXPECT_FLOAT_EQ(two[2 * p + 1], -2.0f * one[p]);
  }
}

}  // namespace
}  // namespace lambent::baker
