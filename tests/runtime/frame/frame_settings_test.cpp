// Tests the table of settings, and what a changed material still needs a bake for.
#include "runtime/frame/frame_settings.hpp"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "runtime/draws/surface_record.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/world/material_rebake.hpp"
#include "tests/support/material_values.hpp"

namespace lambent::frame {
namespace {

TEST(FrameSettings, RowsGiveBackWhatIsPutAndStartAtTheDefaults) {
  std::set<std::string_view> names;
  for (const SettingRow& row : settingRows()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    FrameSettings settings;
    const double before = row.get(settings);
    for (const double value : {row.least, row.greatest, row.finest.value_or(row.least)}) {
      ASSERT_TRUE(putSetting(row, settings, value)) << row.name << " " << value;
      EXPECT_EQ(row.get(settings), value) << row.name;
      const Result<double> again = parseSetting(row, settingWord(row, settings));
      ASSERT_TRUE(again) << row.name;
      EXPECT_EQ(*again, value) << row.name;
    }
    for (const double value : {row.least - 1.0, row.greatest + 1.0})
      EXPECT_FALSE(putSetting(row, settings, value)) << row.name;
    EXPECT_FALSE(parseSetting(row, "much")) << row.name;
    ASSERT_TRUE(putSetting(row, settings, before));
    EXPECT_EQ(settings, FrameSettings{}) << row.name << " changes nothing else";
  }
  FrameSettings settings;
  EXPECT_FALSE(putSetting(*findSetting("order"), settings, 2.5)) << "whole numbers only";
}

TEST(FrameSettings, WordsAreThoseOfTheCommandLine) {
  FrameSettings settings;
  ASSERT_TRUE(putSetting(settings, "transfer", "shadowed"));
  ASSERT_TRUE(putSetting(settings, "specular-environment", "off"));
  ASSERT_TRUE(putSetting(settings, "reflection-probes", "off"));
  ASSERT_TRUE(putSetting(settings, "exposure", "-1.5"));
  EXPECT_EQ(settings.transfer, evaluate::TransferMode::Shadowed);
  EXPECT_FALSE(settings.residual);
  EXPECT_EQ(settings.exposure_ev, -1.5f);
  ASSERT_TRUE(putSetting(settings, "exposure", "auto"));
  EXPECT_FALSE(settings.exposure_ev);
  const Result<void> unknown = putSetting(settings, "sharpness", "1");
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().line().find("march-step"), std::string::npos) << "names those that there are";
}

TEST(BrdfChoice, IsThatOfTheMaterialNowWhereThereIsATableForIt) {
  using Family = bundle::BrdfFamily;
  const Family all[] = {Family::Measured, Family::Ggx, Family::AnisotropicGgx, Family::Measured};
  const Family isotropic[] = {Family::Ggx}, brushed[] = {Family::AnisotropicGgx},
               measured[] = {Family::Measured};
  gltf::Material plain, along, paint, other_paint;
  along.anisotropy = 0.5f;
  paint.brdf = 0;
  other_paint.brdf = 3;
  EXPECT_EQ(brdfChoiceOf(all, plain, paint).table, 1);
  EXPECT_EQ(brdfChoiceOf(all, along, plain).table, 2);
  EXPECT_EQ(brdfChoiceOf(all, other_paint, plain).table, 3);
  EXPECT_EQ(brdfChoiceOf(all, other_paint, plain).family, Family::Measured);
  EXPECT_EQ(brdfChoiceOf(isotropic, along, plain).family, Family::Ggx) << "its anisotropy does not show";
  EXPECT_EQ(brdfChoiceOf(brushed, plain, along).family, Family::AnisotropicGgx) << "of strength 0";
  EXPECT_EQ(brdfChoiceOf(measured, plain, paint).table, 0) << "no factors without a table: as baked";
  EXPECT_EQ(brdfChoiceOf(isotropic, paint, plain).table, 0);
  EXPECT_EQ(brdfChoiceOf({}, plain, plain).table, -1);
}

TEST(MaterialRebake, SaysWhatDoesNotShow) {
  gltf::Material baked;
  baked.metallic = 0.0f;
  const auto fields = [&](const gltf::Material& now, const MaterialUse& use) {
    std::set<std::string> found;
    for (const RebakeReason& reason : needsRebake(now, baked, use)) {
      EXPECT_EQ(reason.sentence.back(), '.');
      found.insert(reason.field + (reason.shows ? " nearly" : ""));
    }
    return found;
  };
  const MaterialUse direct{.diffuse = true}, bounced{.diffuse = true, .bounces = true, .seen = true};
  const MaterialUse shiny{.glossy = true, .tables = {bundle::BrdfFamily::Ggx}};
  using Fields = std::set<std::string>;
  gltf::Material now = baked;
  EXPECT_EQ(fields(now, bounced), Fields{}) << "nothing changed";
  now.base_color = {0.5f, 0.2f, 0.1f, 1.0f};
  EXPECT_EQ(fields(now, direct), Fields{}) << "direct light on a diffuse surface is exact";
  EXPECT_EQ(fields(now, bounced), Fields{"base_color nearly"});
  now = baked;
  now.roughness = 0.4f;
  EXPECT_EQ(fields(now, direct), Fields{"roughness"});
  now.alpha_mode = baked.alpha_mode = gltf::AlphaMode::Mask;
  now.alpha_cutoff = 0.7f;
  EXPECT_EQ(fields(now, direct), (Fields{"roughness", "alpha_cutoff nearly"}));
  baked.roughness = 0.5f;
  now = baked;
  now.roughness = 0.2f;
  EXPECT_EQ(fields(now, shiny), Fields{}) << "the table has all roughnesses";
  now.anisotropy = 0.5f;
  EXPECT_EQ(fields(now, shiny), Fields{"anisotropy"});
  now = baked;
  now.brdf = 2;
  EXPECT_EQ(fields(now, shiny), Fields{"brdf"});
  const MaterialUse layered{.diffuse = true, .layered = true, .tables = {bundle::BrdfFamily::Ggx}};
  now = baked;
  now.roughness = 0.9f;
  EXPECT_EQ(fields(now, layered), Fields{}) << "the layer has all roughnesses";
  now.metallic = 1.0f;
  EXPECT_EQ(fields(now, layered), Fields{"metallic nearly"});
  now = baked;
  now.specular = 0.0f;
  EXPECT_EQ(fields(now, layered), Fields{}) << "a layer that reflects nothing is none";
  now.anisotropy = 0.5f;
  EXPECT_EQ(fields(now, layered), Fields{"anisotropy"});
  now = baked;
  now.emissive = glm::vec3(1.0f);
  EXPECT_EQ(fields(now, shiny), Fields{"emission nearly"});
}

TEST(MaterialRebake, IsAskedForByEveryValueOfReflection) {
  const MaterialUse use{.glossy = true, .bounces = true, .tables = {bundle::BrdfFamily::AnisotropicGgx}};
  const gltf::Material baked = testing::materialWithEverything();
  gltf::forEachLiveValue([&](const auto& field, const auto& live) {
    if (field.part != gltf::MaterialPart::Reflection) return;
    const auto reasons = needsRebake(testing::changed(baked, field), baked, use);
    ASSERT_FALSE(reasons.empty()) << live.name;
    EXPECT_EQ(reasons.back().field, live.name);
  });
}

TEST(Quality, SetsWhatItNamesAndIsToldByThat) {
  ASSERT_EQ(qualityNames().size(), 3u);
  for (const std::string_view name : qualityNames()) {
    FrameSettings settings;
    settings.order = 3;
    ASSERT_TRUE(putQuality(settings, name));
    EXPECT_EQ(qualityOf(settings), name);
    EXPECT_EQ(settings.order, 3u) << "what it does not name stays";
    // It names all that it sets.
    FrameSettings put;
    put.order = 3;
    for (const std::string_view row : qualitySettings())
      ASSERT_TRUE(putSetting(put, row, settingWord(*findSetting(row), settings)));
    EXPECT_EQ(put, settings);
    settings.key_samples = 17;
    EXPECT_EQ(qualityOf(settings), "");
  }
  FrameSettings settings;
  EXPECT_EQ(qualityOf(settings), "default");
  ASSERT_TRUE(putQuality(settings, "high"));
  ASSERT_TRUE(putQuality(settings, "default"));
  EXPECT_EQ(settings, FrameSettings{}) << "nothing of the one before is left";
  EXPECT_FALSE(putQuality(settings, "best"));
}

}  // namespace
}  // namespace lambent::frame
