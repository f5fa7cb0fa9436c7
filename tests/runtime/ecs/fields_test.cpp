#include "runtime/ecs/fields.hpp"

#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

namespace lambent::ecs {
namespace {

struct Lamp {
  float power_cd = 1.0f;
  int samples = 4;
  bool lit = true;
  std::string note = "new";
  int derived = 0;

  static constexpr std::string_view kComponentName = "Lamp";
  static auto fields() {
    return std::tuple{Field{"power", &Lamp::power_cd, 1.0f, "cd", Range{0.0f, 1000.0f}},
                      Field{"samples", &Lamp::samples, 4, "", Range{1, 64}}, Field{"lit", &Lamp::lit, true},
                      Field{"note", &Lamp::note, "new"}};
  }
};

TEST(Fields, AreVisitedByNameInTheOrderOfTheirDeclaration) {
  Lamp lamp;
  std::vector<std::string> names;
  forEachField(lamp, [&](const auto& field, auto& value) {
    names.emplace_back(field.name);
    EXPECT_EQ(value, field.default_value);
    if constexpr (std::is_same_v<std::remove_reference_t<decltype(value)>, float>) value = 2.5f;
  });
  EXPECT_EQ(names, (std::vector<std::string>{"power", "samples", "lit", "note"})) << "not what is derived";
  EXPECT_EQ(lamp.power_cd, 2.5f);
}

TEST(Fields, RangesIncludeTheirEndsAndExcludeNan) {
  const auto power = std::get<0>(Lamp::fields());
  EXPECT_EQ(power.unit, "cd");
  EXPECT_TRUE(withinRange(power, 0.0f));
  EXPECT_TRUE(withinRange(power, 1000.0f));
  EXPECT_FALSE(withinRange(power, -0.001f));
  EXPECT_FALSE(withinRange(power, std::nanf("")));
  EXPECT_TRUE(withinRange(std::get<2>(Lamp::fields()), false)) << "a field without a range takes any value";
}

}  // namespace
}  // namespace lambent::ecs
