// Tests that every word parses to what the documentation says, and nothing else parses.
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/spec/camera.hpp"
#include "runtime/spec/distant_lights.hpp"
#include "runtime/spec/light.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::spec {
namespace {

TEST(SpecNumbers, TakeOnlyWholeFiniteNumbers) {
  EXPECT_EQ(parseNumber("-1.5e2"), -150.0f);
  EXPECT_EQ(parseNumber(".25"), 0.25f);
  for (const char* wrong :
       {"", " 1", "1 ", "1x", "0x10", "nan", "inf", "-inf", "1e999", "1,2", "--1", "+1", "1..2"})
    EXPECT_FALSE(parseNumber(wrong)) << wrong;
  EXPECT_EQ(parseNumbers("1,2,3")->size(), 3u);
  for (const char* wrong : {"", ",", "1,", ",1", "1,,2", "1, 2", "1;2"})
    EXPECT_FALSE(parseNumbers(wrong)) << wrong;
}

TEST(SpecLight, ParsesConstantSunAndProbe) {
  const Result<Light> constant = parseLight("constant:1,0.5,0");
  ASSERT_TRUE(constant) << constant.error().line();
  EXPECT_EQ(std::get<ConstantLight>(*constant).radiance, glm::vec3(1.0f, 0.5f, 0.0f));

  const Result<Light> sun = parseLight("sun:-45,30,2.5,10,9,8");
  ASSERT_TRUE(sun) << sun.error().line();
  EXPECT_EQ(std::get<SunLight>(*sun).azimuth_deg, -45.0f);
  EXPECT_EQ(std::get<SunLight>(*sun).elevation_deg, 30.0f);
  EXPECT_EQ(std::get<SunLight>(*sun).angle_deg, 2.5f);
  EXPECT_EQ(std::get<SunLight>(*sun).radiance, glm::vec3(10.0f, 9.0f, 8.0f));

  const Result<Light> grey = parseLight("sun:0,90,180,3");
  ASSERT_TRUE(grey) << grey.error().line();
  EXPECT_EQ(std::get<SunLight>(*grey).radiance, glm::vec3(3.0f));

  const Result<Light> environment_map = parseLight("some folder/Grace.HDR");
  ASSERT_TRUE(environment_map) << environment_map.error().line();
  EXPECT_EQ(std::get<EnvironmentMapLight>(*environment_map).file, "some folder/Grace.HDR");
  EXPECT_FALSE(std::get<EnvironmentMapLight>(*environment_map).layout);
}

TEST(SpecLight, RefusesEverythingElseAndShowsTheForm) {
  const std::vector<std::pair<const char*, std::vector<const char*>>> wrong_by_form = {
      {"constant:R,G,B",
       {"constant:", "constant:1", "constant:1,2", "constant:1,2,3,4", "constant:1,2,-3", "constant:1,2,nan",
        "constant:1,2,3e38", "constant:1,2,3 "}},
      {"sun:AZ,EL,ANGLE,R[,G,B]",
       {"sun:", "sun:1,2,3", "sun:1,2,3,4,5", "sun:1,2,3,4,5,6,7", "sun:0,91,1,1", "sun:0,-91,1,1",
        "sun:0,0,0,1", "sun:0,0,181,1", "sun:0,0,1,-1", "sun:0,0,1,3e38", "sun:0,0,1,1x", "sun:inf,0,1,1"}},
      {"sphere:X,Y,Z,RADIUS,R[,G,B]",
       {"sphere:", "sphere:0,0,0,1", "sphere:0,0,0,1,1,1", "sphere:0,0,0,-1,1", "sphere:0,0,0,1,-1",
        "sphere:0,nan,0,1,1", "sphere:0,0,0,1,1,1,1,1"}},
      {"disc:X,Y,Z,NX,NY,NZ,RADIUS,R[,G,B]",
       {"disc:", "disc:0,0,0,0,1,0,1", "disc:0,0,0,0,1,0,1,1,1", "disc:0,0,0,0,0,0,1,1",
        "disc:0,0,0,0,1,0,-1,1", "disc:0,0,0,0,1,0,1,-1", "disc:0,0,0,0,inf,0,1,1"}},
      {"environment map file (.hdr or .exr)",
       {"", "sunn:1,2,3,4", "Sun:1,2,3,4", "probe.png", "hdr", "constant"}}};
  for (const auto& [form, words] : wrong_by_form)
    for (const char* wrong : words) {
      const Result<Light> light = parseLight(wrong);
      ASSERT_FALSE(light) << wrong;
      EXPECT_NE(light.error().line().find(form), std::string::npos) << light.error().line();
    }
}

TEST(SpecLight, ParsesLightsThatStandInTheScene) {
  const Result<Light> sphere = parseLight("sphere:1,-2,3.5,0.25,5,4,3");
  ASSERT_TRUE(sphere) << sphere.error().line();
  EXPECT_EQ(std::get<SphereLight>(*sphere).position_ws, glm::dvec3(1.0, -2.0, 3.5));
  EXPECT_EQ(std::get<SphereLight>(*sphere).radius_m, 0.25f);
  EXPECT_EQ(std::get<SphereLight>(*sphere).radiance, glm::vec3(5.0f, 4.0f, 3.0f));
  EXPECT_EQ(std::get<SphereLight>(parseLight("sphere:0,1,0,0.1,7").value()).radiance, glm::vec3(7.0f));
  EXPECT_EQ(std::get<SphereLight>(parseLight("sphere:0,1,0,0,7").value()).radius_m, 0.0f)
      << "gives no light, but is a sphere";

  const Result<Light> disc = parseLight("disc:1,2,3,0,-2,0,0.5,9,8,7");
  ASSERT_TRUE(disc) << disc.error().line();
  EXPECT_EQ(std::get<DiscLight>(*disc).position_ws, glm::dvec3(1.0, 2.0, 3.0));
  EXPECT_EQ(std::get<DiscLight>(*disc).normal_ws, glm::vec3(0.0f, -1.0f, 0.0f)) << "unit";
  EXPECT_EQ(std::get<DiscLight>(*disc).radius_m, 0.5f);
  EXPECT_EQ(std::get<DiscLight>(*disc).radiance, glm::vec3(9.0f, 8.0f, 7.0f));
  for (const char* word : {"disc:0,0,0,1e-40,0,0,1,1", "disc:0,0,0,3e38,0,0,1,1"})
    EXPECT_EQ(std::get<DiscLight>(parseLight(word).value()).normal_ws, glm::vec3(1.0f, 0.0f, 0.0f)) << word;

  const std::vector<Light> lights = {*sphere, ConstantLight{}, *disc, *sphere};
  const std::vector<LocalLight> local = localLights(lights);
  ASSERT_EQ(local.size(), 3u);
  EXPECT_TRUE(std::holds_alternative<DiscLight>(local[1]));
  const std::vector<Light> far = {parseLight("sphere:5412345.125,0,-1,0.25,5").value()};
  EXPECT_EQ(std::get<SphereLight>(localLights(far, {5412344.0, 0.0, 0.0})[0]).position_ws,
            glm::dvec3(1.125, 0.0, -1.0));
  const Result<DistantLights> distant = loadDistantLights(lights);
  ASSERT_TRUE(distant);
  EXPECT_TRUE(distant->discs.empty() && distant->environment_maps.empty()) << "they do not stand at infinity";
  EXPECT_EQ(distant->constant, glm::vec3(1.0f));
}

TEST(SpecLight, NoGarbageCrashesOrSlipsThrough) {
  std::mt19937 random(7);
  const std::string alphabet = "0123456789.,-+eE:x nanifsucophdr/";
  int accepted = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string word = i % 3 == 0 ? "sun:" : i % 3 == 1 ? "constant:" : "";
    for (std::size_t length = random() % 16; length > 0; --length)
      word += alphabet[random() % alphabet.size()];
    const Result<Light> light = parseLight(word);
    static_cast<void>(parseSize(word));
    if (!light) continue;
    ++accepted;
    if (const auto* sun = std::get_if<SunLight>(&*light)) {
      EXPECT_TRUE(sun->angle_deg > 0.0f && sun->angle_deg <= 180.0f) << word;
      EXPECT_GE(sun->radiance.x, 0.0f) << word;
    }
  }
  EXPECT_LT(accepted, 1000);
}

TEST(SpecLight, AzimuthZeroIsFrontAndNinetyIsRight) {
  constexpr float kTolerance = 1e-7f;  // float rounding of unit vectors
  const auto near = [&](glm::vec3 a, glm::vec3 b) { return glm::length(a - b) < kTolerance; };
  EXPECT_TRUE(near(directionFromAzimuthElevation(0, 0), {0, 0, 1}));
  EXPECT_TRUE(near(directionFromAzimuthElevation(90, 0), {1, 0, 0}));
  EXPECT_TRUE(near(directionFromAzimuthElevation(180, 0), {0, 0, -1}));
  EXPECT_TRUE(near(directionFromAzimuthElevation(123, 90), {0, 1, 0}));
  EXPECT_TRUE(near(directionFromAzimuthElevation(0, -90), {0, -1, 0}));
}

TEST(SpecRotate, PositiveTurnsTakeFrontToRightAndAddToAzimuths) {
  constexpr float kTolerance = 2e-7f;
  EXPECT_LT(glm::length(lightRotation(90) * glm::vec3(0, 0, 1) - glm::vec3(1, 0, 0)), kTolerance);
  EXPECT_LT(glm::length(lightRotation(40) * directionFromAzimuthElevation(25, 10) -
                        directionFromAzimuthElevation(65, 10)),
            kTolerance);
  EXPECT_LT(glm::length(lightRotation(-725) * glm::vec3(0, 0, 1) - directionFromAzimuthElevation(-5, 0)),
            kTolerance);
  EXPECT_EQ(parseDegrees("-22.5").value(), -22.5f);
  EXPECT_FALSE(parseDegrees("90deg"));
}

TEST(KeyEdit, SaysWhichKeyLightStandsWhereAndHowItShines) {
  const auto edit = parseKeyEdit("key:90,0,0,90,0.5");
  ASSERT_TRUE(edit) << edit.error().line();
  EXPECT_EQ(edit->set, 0u);
  EXPECT_LT(glm::distance(edit->found, glm::vec3(1, 0, 0)), 1e-6f);
  EXPECT_LT(glm::distance(edit->towards, glm::vec3(0, 1, 0)), 1e-6f);
  EXPECT_EQ(edit->factor, glm::vec3(0.5f)) << "one factor is that of all channels";
  const auto fade = parseKeyEdit("fade-key:0,0,0,0,1,0,0.25");
  ASSERT_TRUE(fade);
  EXPECT_EQ(fade->set, 1u);
  EXPECT_EQ(fade->factor, glm::vec3(1.0f, 0.0f, 0.25f));
}

TEST(KeyEdit, WordsReadBackToTheSameEditWithinAThousandthOfADegree) {
  for (const glm::vec3& direction :
       {glm::vec3(0.3f, 0.8f, -0.5f), glm::vec3(-0.7f, -0.1f, 0.2f), glm::vec3(0, 1, 0), glm::vec3(0, -1, 0)})
    for (const std::size_t set : {0u, 1u}) {
      const KeyEdit edit{.set = set,
                         .found = glm::normalize(direction),
                         .towards = glm::normalize(glm::vec3(direction.z, direction.y, direction.x)),
                         .factor = {0.1f, 2.0f, 1.0f / 3.0f}};
      const auto read = parseKeyEdit(keyEditWord(edit));
      ASSERT_TRUE(read) << keyEditWord(edit);
      EXPECT_EQ(read->set, set);
      EXPECT_LT(glm::distance(read->found, edit.found), 2e-5f) << keyEditWord(edit);
      EXPECT_LT(glm::distance(read->towards, edit.towards), 2e-5f) << keyEditWord(edit);
      EXPECT_EQ(read->factor, edit.factor);
    }
  EXPECT_EQ(keyEditWord({.found = {0, 0, 1}, .towards = {1, 0, 0}}), "key:0,0,90,0,1");
}

TEST(KeyEdit, RefusesOtherWordsAndSaysTheForm) {
  for (const char* word : {"", "sun:1,2,3,4", "key:", "key:1,2,3,4", "key:1,2,3,4,5,6", "key:0,91,0,0,1",
                           "key:0,0,0,-91,1", "key:0,0,0,0,-1", "key:0,0,0,0,2e6", "key:0,0,0,0,x"}) {
    const auto edit = parseKeyEdit(word);
    ASSERT_FALSE(edit) << word;
    EXPECT_NE(edit.error().line().find("key:AZ,EL,TO_AZ,TO_EL,R[,G,B]"), std::string::npos) << word;
  }
}

}  // namespace
}  // namespace lambent::spec
