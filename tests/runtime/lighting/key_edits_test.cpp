// Tests key lights of an environment map that are moved, dimmed and tinted: their discs change, and nothing
// else.
#include <cmath>
#include <filesystem>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <unistd.h>

#include "runtime/lighting/environment.hpp"
#include "runtime/sh/image_layout.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::lighting {

namespace {

const glm::dvec3 kHigh = glm::normalize(glm::dvec3(0.4, 0.7, -0.3));
const glm::dvec3 kLow = glm::normalize(glm::dvec3(-0.6, 0.2, 0.5));

// Makes a soft sky with two suns of 1.7 degrees.
class KeyEdits : public ::testing::Test {
 protected:
  KeyEdits() : file_(std::filesystem::path(::testing::TempDir()) / (std::to_string(getpid()) + "-suns.hdr")) {
    spec::RgbImage image{.width = 256, .height = 128, .texels = {}};
    for (int y = 0; y < 128; ++y)
      for (int x = 0; x < 256; ++x) {
        const glm::dvec3 dir = sh::texelDirection(sh::ImageLayout::LatLong, 256, 128, x, y);
        glm::vec3 texel = glm::vec3(1.0f, 1.2f, 1.5f) * static_cast<float>(1.0 + 0.4 * dir.y);
        if (glm::distance(dir, kHigh) < 0.03) texel += glm::vec3(3000.0f, 2800.0f, 2500.0f);
        if (glm::distance(dir, kLow) < 0.03) texel += glm::vec3(2000.0f, 1000.0f, 500.0f);
        image.texels.push_back(texel);
      }
    EXPECT_TRUE(spec::writeHdr(file_, image));
    Result<Environment> made = Environment::create({spec::EnvironmentMapLight{file_, std::nullopt}});
    EXPECT_TRUE(made) << made.error().line();
    if (made) environment_.emplace(std::move(*made));
    environment_->setMostKeys(16);
  }
  ~KeyEdits() override { std::filesystem::remove(file_); }

  // Returns what the eye sees, as bands 0 and 1.
  sh::LightVector seen() const {
    const Environment::Shown shown = environment_->shownOf(0);
    sh::LightVector light = sh::constantLight(2, shown.constant);
    for (const spec::EnvironmentMap* environment_map : shown.environment_maps)
      light +=
          sh::projectImage(2, environment_map->layout, static_cast<int>(environment_map->image.width),
                           static_cast<int>(environment_map->image.height), environment_map->image.texels);
    for (const Disc& disc : shown.discs)
      light += sh::discLight(2, disc.direction, static_cast<double>(disc.radius_rad), disc.radiance);
    return light;
  }
  spec::KeyEdit editOf(std::size_t key) const {
    const Disc found = environment_->foundKeys()[key].found;
    return {.found = found.direction, .towards = found.direction};
  }

  std::filesystem::path file_;
  std::optional<Environment> environment_;
};

void expectSameLight(const sh::LightVector& a, const sh::LightVector& b, float tolerance, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    EXPECT_LT(glm::distance(a.c[i], b.c[i]), tolerance * glm::length(b.c[0])) << "coefficient " << i;
}

}  // namespace

TEST_F(KeyEdits, SayWhereEachKeyLightWasFound) {
  const auto keys = environment_->foundKeys();
  ASSERT_EQ(keys.size(), 2u);
  ASSERT_EQ(environment_->keys().size(), 2u);
  EXPECT_LT(glm::distance(keys[0].found.direction, glm::vec3(kHigh)), 0.01f) << "the stronger one is first";
  EXPECT_LT(glm::distance(keys[1].found.direction, glm::vec3(kLow)), 0.01f);
  for (const Environment::FoundKey& key : keys) {
    EXPECT_TRUE(key.origin.in_map);
    EXPECT_EQ(key.origin.index, 0u);
    EXPECT_FALSE(key.edit);
    EXPECT_EQ(key.found.radiance, key.now.radiance);
  }
}

TEST_F(KeyEdits, SunsOfWordsAreToldFromThoseOfPictures) {
  ASSERT_TRUE(environment_->setLights(
      {spec::SunLight{
           .azimuth_deg = 10, .elevation_deg = 40, .angle_deg = 0.5f, .radiance = glm::vec3(20000)},
       spec::EnvironmentMapLight{file_, std::nullopt},
       spec::SunLight{
           .azimuth_deg = 190, .elevation_deg = 40, .angle_deg = 1, .radiance = glm::vec3(9000)}}));
  const auto keys = environment_->foundKeys();
  ASSERT_EQ(keys.size(), 4u);
  std::size_t of_map = 0;
  for (const Environment::FoundKey& key : keys) {
    of_map += key.origin.in_map;
    if (key.origin.in_map) continue;
    EXPECT_EQ(key.found.direction, environment_->set(0).discs[key.origin.index].direction);
    EXPECT_FALSE(key.origin.piece);
  }
  EXPECT_EQ(of_map, 2u);
}

TEST_F(KeyEdits, AnEditThatChangesNothingKeepsAllOfTheLight) {
  const sh::LightVector light = environment_->light(), before = seen();
  const std::uint64_t rest = environment_->restVersion();
  environment_->setKeyEdits({editOf(0), editOf(1)});
  EXPECT_TRUE(environment_->foundKeys()[0].edit);
  EXPECT_TRUE(environment_->foundKeys()[1].edit);
  EXPECT_EQ(environment_->restVersion(), rest);
  for (std::size_t i = 0; i < 64; ++i) EXPECT_EQ(environment_->light().c[i], light.c[i]) << i;
  // The eye sees discs in place of texels: all of their flux, from where it came. Band 1 of a key light has
  // one direction for all channels.
  expectSameLight(seen(), before, 1e-4f, 1);
  expectSameLight(seen(), before, 2e-3f, 4);
  EXPECT_EQ(environment_->shownOf(0).discs.size(), 2u);
}

TEST_F(KeyEdits, AKeyLightThatIsMovedAndDimmedIsThatDiscAndTheRestStays) {
  const auto found = environment_->foundKeys()[0].found;
  const sh::LightVector rest = environment_->restLight();
  spec::KeyEdit edit = editOf(0);
  edit.towards = glm::normalize(glm::vec3(-0.2f, 0.5f, 0.8f));
  edit.factor = {0.5f, 0.25f, 2.0f};
  environment_->setKeyEdits({edit});
  const Disc now = environment_->foundKeys()[0].now;
  EXPECT_EQ(now.direction, edit.towards);
  EXPECT_EQ(now.radius_rad, found.radius_rad);
  EXPECT_EQ(now.radiance, found.radiance * edit.factor);
  EXPECT_EQ(environment_->keys()[0].direction, now.direction) << "where its shadows come from";
  for (std::size_t i = 0; i < 64; ++i) EXPECT_EQ(environment_->restLight().c[i], rest.c[i]) << i;
  sh::LightVector keys = sh::discLight(8, now.direction, static_cast<double>(now.radius_rad), now.radiance);
  const Disc other = environment_->foundKeys()[1].now;
  keys += sh::discLight(8, other.direction, static_cast<double>(other.radius_rad), other.radiance);
  expectSameLight(environment_->keyLight(), keys, 1e-5f, 64);
  // The eye sees the rest and the keys, as before the edit.
  sh::LightVector all = environment_->light().truncated(2);
  expectSameLight(seen(), all, 2e-3f, 4);
}

TEST_F(KeyEdits, VersionsTellWhatADragLeavesAsItIs) {
  spec::KeyEdit edit = editOf(0);
  environment_->setKeyEdits({edit});
  const std::uint64_t version = environment_->version(), lights = environment_->lightsVersion(),
                      pictures = environment_->picturesVersion(), rest = environment_->restVersion();
  edit.towards = glm::vec3(0, 1, 0);
  environment_->setKeyEdits({edit});
  EXPECT_NE(environment_->version(), version);
  EXPECT_NE(environment_->lightsVersion(), lights);
  EXPECT_EQ(environment_->picturesVersion(), pictures);
  EXPECT_EQ(environment_->restVersion(), rest);
  environment_->setKeyEdits({edit, editOf(1)});
  EXPECT_NE(environment_->picturesVersion(), pictures);
  EXPECT_EQ(environment_->restVersion(), rest);
}

TEST_F(KeyEdits, AnEditWaitsWhereItsKeyLightIsNotFound) {
  spec::KeyEdit edit = editOf(1);
  edit.factor = glm::vec3(0.0f);
  environment_->setKeyEdits({edit});
  const sh::LightVector edited = environment_->light();
  environment_->setMostKeys(0);
  EXPECT_TRUE(environment_->foundKeys().empty());
  EXPECT_EQ(environment_->shownOf(0).environment_maps[0], &environment_->set(0).environment_maps[0]);
  environment_->setMostKeys(16);
  for (std::size_t i = 0; i < 64; ++i) EXPECT_EQ(environment_->light().c[i], edited.c[i]) << i;
  // The first edit belongs to no key light, the second to the other set.
  edit.found = glm::vec3(0, -1, 0);
  environment_->setKeyEdits({edit});
  EXPECT_FALSE(environment_->foundKeys()[1].edit);
  spec::KeyEdit other = editOf(1);
  other.set = 1;
  environment_->setKeyEdits({other});
  EXPECT_FALSE(environment_->foundKeys()[1].edit);
}

TEST_F(KeyEdits, TurnAndFadeGoOnFromTheEditedLight) {
  spec::KeyEdit edit = editOf(0);
  edit.towards = glm::vec3(0, 0, 1);
  environment_->setKeyEdits({edit});
  environment_->setTurn(90.0f);
  environment_->setIntensity(0.5f);
  EXPECT_LT(glm::distance(environment_->keys()[0].direction, glm::vec3(1, 0, 0)), 1e-6f);
  EXPECT_LT(glm::distance(environment_->keys()[0].radiance, 0.5f * environment_->foundKeys()[0].now.radiance),
            1e-3f);
}

}  // namespace lambent::lighting
