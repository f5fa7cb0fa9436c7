#include "runtime/ecs/fields.hpp"

#include <cmath>
#include <map>
#include <sstream>
#include <string>

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

// Imitates a world file: it knows no component, only fields.
template <class Component>
std::map<std::string, std::string> save(const Component& component) {
  std::map<std::string, std::string> saved;
  forEachField(component, [&](const auto& field, const auto& value) {
    std::ostringstream text;
    text << value;
    saved[std::string(field.name)] = text.str();
  });
  return saved;
}
template <class Component>
void load(Component& component, const std::map<std::string, std::string>& saved) {
  forEachField(component, [&](const auto& field, auto& value) {
    std::istringstream(saved.at(std::string(field.name))) >> value;
  });
}

TEST(Fields, RoundTripThroughTextByNameAlone) {
  const Lamp lamp{.power_cd = 2.5f, .samples = 16, .lit = false, .note = "moved", .derived = 9};
  const auto saved = save(lamp);
  EXPECT_EQ(saved, (std::map<std::string, std::string>{
                       {"power", "2.5"}, {"samples", "16"}, {"lit", "0"}, {"note", "moved"}}));
  Lamp read;
  load(read, saved);
  EXPECT_EQ(save(read), saved);
  EXPECT_EQ(read.derived, 0) << "what is not declared is not carried";
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
