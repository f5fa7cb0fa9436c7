#include "runtime/bundle/brdf_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/differences.hpp"

namespace lambent::bundle {
namespace {

constexpr float kWhole = 3.5449077f;  // sqrt(4 pi)

// Makes values that depend on every index, small enough for albedos below 1.
BrdfTable makeTable(std::uint32_t order, std::uint32_t lobes, std::uint32_t azimuths,
                    std::uint32_t strengths) {
  BrdfTable table{.order = order,
                  .lobes = lobes,
                  .angles = 5,
                  .azimuths = azimuths,
                  .roughnesses = 3,
                  .strengths = strengths,
                  .values = {}};
  for (std::size_t i = 0; i < table.nodes() * table.nodeValues(); ++i) {
    const bool albedo = i % table.coefficients() == 0;
    const auto step = static_cast<float>(i * 37 % 101) / 101.0f;
    table.values.push_back(albedo ? 0.12f * step : 0.3f * (step - 0.5f));
  }
  return table;
}

float& value(BrdfTable& table, std::size_t strength, std::size_t roughness, std::size_t azimuth,
             std::size_t angle, std::size_t lobe, std::size_t coefficient) {
  const std::size_t node =
      ((strength * table.roughnesses + roughness) * table.azimuths + azimuth) * table.angles + angle;
  return table.values[node * table.nodeValues() + lobe * table.coefficients() + coefficient];
}

float cosineAt(float u) {
  return 1.0f - (1.0f - u * u) * (1.0f - u * u);
}

TEST(BrdfTable, GivesItsNodesBack) {
  BrdfTable table = makeTable(4, 2, 3, 2);
  std::vector<float> b(2 * 16);
  for (std::size_t s = 0; s < 2; ++s)
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t p = 0; p < 3; ++p)
        for (std::size_t a = 0; a < 5; ++a) {
          const float u = static_cast<float>(a) / 4.0f, phi = static_cast<float>(p) / 2.0f * 1.5707964f;
          lookUp(table, {cosineAt(u), std::max(std::cos(phi), 0.0f), std::sin(phi)},
                 static_cast<float>(r) / 2.0f, static_cast<float>(s), b);
          for (std::size_t lobe = 0; lobe < 2; ++lobe)
            for (std::size_t k = 0; k < 16; ++k)
              EXPECT_NEAR(b[lobe * 16 + k], value(table, s, r, p, a, lobe, k), 1e-6f);
        }
}

TEST(BrdfTable, IsLinearBetweenNodesOfTheAngleAxis) {
  BrdfTable table = makeTable(3, 3, 1, 1);
  std::vector<float> b(3 * 9);
  const float u = 0.4f;  // between nodes 1 and 2, at 0.6
  lookUp(table, {cosineAt(u), 1.0f, 0.0f}, 0.75f, 0.0f, b);
  for (std::size_t lobe = 0; lobe < 3; ++lobe)
    for (std::size_t l = 0; l < 3; ++l)
      for (std::size_t m = 0; m <= l; ++m) {
        const std::size_t c = l * (l + 1) / 2 + m;
        const auto row = [&](std::size_t r) {
          return 0.4f * value(table, 0, r, 0, 1, lobe, c) + 0.6f * value(table, 0, r, 0, 2, lobe, c);
        };
        EXPECT_NEAR(b[lobe * 9 + l * (l + 1) + m], 0.5f * row(1) + 0.5f * row(2), 1e-6f);
        if (m > 0) {
          EXPECT_EQ(b[lobe * 9 + l * (l + 1) - m], 0.0f) << "it mirrors in the xz plane";
        }
      }
}

// A BRDF that mirrors with its view: the frame of the mirrored view has the opposite y axis.
TEST(BrdfTable, ReflectsIntoTheOtherQuadrants) {
  const BrdfTable table = makeTable(5, 2, 4, 1);
  std::vector<float> b(50), other(50);
  const float cosine = std::cos(0.6f), sine = std::sin(0.6f);
  lookUp(table, {0.3f, cosine, sine}, 0.6f, 0.0f, b);
  lookUp(table, {0.3f, -cosine, -sine}, 0.6f, 0.0f, other);
  EXPECT_EQ(other, b) << "turned by half";
  for (const float side : {1.0f, -1.0f}) {
    lookUp(table, {0.3f, -side * cosine, side * sine}, 0.6f, 0.0f, other);
    std::size_t i = 0;
    for (int lobe = 0; lobe < 2; ++lobe)
      for (int l = 0; l < 5; ++l)
        for (int m = -l; m <= l; ++m, ++i) EXPECT_EQ(other[i], m < 0 ? -b[i] : b[i]) << l << ", " << m;
  }
}

TEST(BrdfTable, StaysInsideForPlacesOutside) {
  BrdfTable table = makeTable(5, 2, 1, 1);
  std::vector<float> b(50), expected(50);
  lookUp(table, {0.0f, 1.0f, 0.0f}, 0.0f, 0.0f, expected);
  lookUp(table, {-0.5f, 1.0f, 0.0f}, -3.0f, -1.0f, b);
  EXPECT_EQ(b, expected);
  lookUp(table, {1.0f, 1.0f, 0.0f}, 1.0f, 1.0f, expected);
  lookUp(table, {1.1f, 1.0f, 0.0f}, 9.0f, 2.0f, b);
  EXPECT_EQ(b, expected);
  lookUp(table, {0.5f, 1.0f, 0.0f}, std::numeric_limits<float>::quiet_NaN(), 0.0f, b);
  for (const float v : b) EXPECT_TRUE(std::isfinite(v));
}

TEST(BrdfTable, ComesBackFromItsPayload) {
  for (BrdfTable table : {makeTable(5, 2, 1, 1), makeTable(6, 3, 1, 1), makeTable(4, 2, 3, 2)}) {
    const auto coefficients = table.coefficients();
    std::fill_n(table.values.begin(), coefficients, 0.0f);  // a lobe of nothing
    const auto bytes = encodeBrdfTable(table);
    const std::size_t lobes = table.nodes() * table.lobes;
    EXPECT_EQ(bytes.size(), 24 + 4 * lobes + 2 * table.values.size());
    const auto back = decodeBrdfTable(bytes, "table");
    ASSERT_TRUE(back) << back.error().line();
    EXPECT_EQ(back->order, table.order);
    EXPECT_EQ(back->lobes, table.lobes);
    EXPECT_EQ(back->angles, table.angles);
    EXPECT_EQ(back->azimuths, table.azimuths);
    EXPECT_EQ(back->roughnesses, table.roughnesses);
    EXPECT_EQ(back->strengths, table.strengths);
    ASSERT_EQ(back->values.size(), table.values.size());
    for (std::size_t lobe = 0; lobe < lobes; ++lobe) {
      float largest = 0.0f;
      for (std::size_t k = 0; k < coefficients; ++k)
        largest = testing::larger(largest, std::abs(table.values[lobe * coefficients + k]));
      for (std::size_t k = lobe * coefficients; k < (lobe + 1) * coefficients; ++k)
        EXPECT_NEAR(back->values[k], table.values[k], 1.01e-4f * largest);
    }
  }
}

// Sizes from a damaged file must not cause large allocations or reads past its end.
TEST(BrdfTable, WithSizesOutOfRangeIsRefused) {
  const auto bytes = encodeBrdfTable(makeTable(3, 2, 2, 2));
  for (std::size_t field = 0; field < 6; ++field)
    for (const std::uint32_t bad : {0u, 1u, 7u, 1025u, 65536u, 0x40000001u, 0x7fffffffu, 0xffffffffu}) {
      auto other = bytes;
      std::uint32_t now = 0;
      std::memcpy(&now, other.data() + 4 * field, 4);
      if (now == bad) continue;
      std::memcpy(other.data() + 4 * field, &bad, 4);
      EXPECT_FALSE(decodeBrdfTable(other, "table")) << field << ": " << bad;
    }
}

TEST(BrdfTable, WithImpossibleValuesIsRefused) {
  const auto with = [](std::size_t index, float v) {
    BrdfTable table = makeTable(5, 2, 1, 1);
    table.values[0] = table.values[15] = 0.0f;
    table.values[index] = v;
    return encodeBrdfTable(table);
  };
  EXPECT_TRUE(decodeBrdfTable(with(0, 0.9f / kWhole), "table"));
  EXPECT_FALSE(decodeBrdfTable(with(0, 1.01f / kWhole), "table")) << "more than all light";
  EXPECT_FALSE(decodeBrdfTable(with(0, -0.01f), "table"));
  // F0 and F90 parts reflect together; red and green do not.
  for (const std::uint32_t lobes : {2u, 3u}) {
    BrdfTable table = makeTable(5, lobes, 1, 1);
    table.values[0] = table.values[15] = 0.7f / kWhole;
    EXPECT_EQ(decodeBrdfTable(encodeBrdfTable(table), "table").has_value(), lobes == 3u);
  }
  auto bytes = with(0, 0.1f);
  for (const float scale :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -1e-6f, 1.0f}) {
    std::memcpy(bytes.data() + 24, &scale, 4);
    EXPECT_FALSE(decodeBrdfTable(bytes, "table")) << scale;
  }
}

}  // namespace
}  // namespace lambent::bundle
