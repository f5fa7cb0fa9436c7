#include "baker/bake/options.hpp"

#include <gtest/gtest.h>

namespace lambent::baker {
namespace {

void expectBack(const BakeOptions& options, Quality quality) {
  const auto settings = options.settings();
  const auto back = BakeOptions::fromSettings(settings);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->settings(), settings);
  EXPECT_EQ(back->quality, quality);
}

TEST(BakeOptions, ComeBackFromTheSettingsThatABundleRecords) {
  for (const Quality quality : {Quality::Draft, Quality::Standard, Quality::High}) {
    BakeOptions options;
    options.quality = quality;
    expectBack(options, quality);
    const auto back = BakeOptions::fromSettings(options.settings());
    EXPECT_EQ(back->rays, 0u) << "the quality's own";
    EXPECT_EQ(back->error_bound, 0.0f);
    EXPECT_LT(back->refine_bound, 0.0f);
  }
  BakeOptions other;
  other.quality = Quality::High;
  other.order = 4, other.glossy_order = 6, other.bounces = 3, other.light_probes = 7, other.max_edge_m = 0.1f;
  other.neighborhood_grid = {64, 48, 8}, other.volume_grid = {16, 24, 32}, other.effects = "diffuse,glossy";
  expectBack(other, Quality::High);
  for (const bool fit : {false, true}) {
    other.fit = fit;
    expectBack(other, Quality::High);
  }
  other.fit = std::nullopt;
  other.rays = 777;
  expectBack(other, Quality::High);
  other.error_bound = 0.0123f, other.refine_bound = 0.0f;  // how far refinement may go still tells
  expectBack(other, Quality::High);
}

TEST(BakeOptions, DoNotComeFromSettingsThatAreNotAll) {
  const auto whole = BakeOptions().settings();
  for (const auto& [name, word] : whole) {
    auto settings = whole;
    settings.erase(name);
    EXPECT_FALSE(BakeOptions::fromSettings(settings)) << "without " << name;
    if (name == "effects") continue;  // any text, until it is asked for
    for (const std::string& wrong : {std::string("1e"), std::string()}) {
      settings[name] = wrong;
      EXPECT_FALSE(BakeOptions::fromSettings(settings)) << name << " " << wrong;
    }
  }
  auto more = whole;
  more.emplace("of another version", "5");
  EXPECT_TRUE(BakeOptions::fromSettings(more));
}

}  // namespace
}  // namespace lambent::baker
