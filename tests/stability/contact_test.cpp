// Tests a body on a floor that is moved as the editor moves bodies, and keeps its contact shadow. Key lights
// use shadow maps, the rest of the light uses its neighborhood, and nothing is darkened twice.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/stability/show.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent {
namespace {

using testing::add;
using testing::constantLight;
using testing::named;
using testing::Show;

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kHalf = 0.25f, kHeight = 0.5f;  // of the body
constexpr float kAlbedo = 0.6f;                 // of the floor

using Contact = testing::GpuTest;

// Makes a black box, and a floor of 4 m; the box is at `place` when the scene is baked.
assets::Scene boxAt(const glm::vec3& place) {
  assets::Scene scene = named("contact");
  add(scene, "floor", assets::plane({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, 0.1f), glm::vec3(kAlbedo), {0, 0, 0},
      false);
  add(scene, "body", assets::box({-kHalf, 0, -kHalf}, {kHalf, kHeight, kHalf}, 0.05f), glm::vec3(0.0f), place,
      true);
  return scene;
}

// Returns the fraction of a white sky that a point of the floor sees at this distance from the middle of the
// box's side: all but the side, a rectangle that is perpendicular to the floor.
float openBeside(float distance) {
  const float x = kHeight / kHalf, y = distance / kHalf, root = std::sqrt(x * x + y * y);
  return 1.0f - 2.0f * (std::atan(1.0f / y) - y / root * std::atan(1.0f / root)) / (2.0f * kPi);
}

// Returns E/pi beside the box's side towards +X.
float seenBeside(Show& show, const glm::vec3& place, float distance) {
  const glm::vec3 at = place + glm::vec3(kHalf + distance, 0, 0);
  return show.patch(at + glm::vec3(1.5f, 1.2f, 0.1f), at).g / kAlbedo;
}

// The body is baked off the floor or on it, and then moved to two places on it.
const glm::vec3 kElsewhere(6, 3, 0), kHere(0, 0, 0), kThere(0.73f, 0, 0.41f);
// At smaller distances the spacing of the grid's points blurs the contact.
constexpr float kNear = 0.06f;

}  // namespace

TEST_F(Contact, ABoxTakesTheSkysLightFromWhatItStandsOnWhereverItWasBaked) {
  for (const glm::vec3& baked : {kHere, kElsewhere}) {
    Show show(boxAt(baked), {constantLight(1.0f)});
    for (const glm::vec3& place : {kHere, kThere}) {
      show.move("body", place);
      for (const float distance : {kNear, 0.12f, 0.25f, 0.5f})
        EXPECT_NEAR(seenBeside(show, place, distance), openBeside(distance), 0.03f)
            << distance << " m beside it, baked at " << baked.x << ", standing at " << place.x;
    }
    // When the body leaves, the floor gets its light back.
    show.move("body", kElsewhere);
    EXPECT_NEAR(seenBeside(show, kHere, kNear), 1.0f, 0.01f);
  }
}

TEST_F(Contact, InTheSunNothingIsDarkenedTwice) {
  constexpr float kSky = 0.3f, kRadius = 2.0f, kRadiance = 700.0f, kElevation = 45.0f;
  const float sine = std::sin(glm::radians(kRadius));
  const float sun = kRadiance * sine * sine * std::sin(glm::radians(kElevation));
  // The sun comes from behind the box, so that the shadow falls on the side towards +X, or from the front.
  for (const bool lit : {false, true}) {
    Show show(boxAt(kElsewhere), {constantLight(kSky), spec::SunLight{.azimuth_deg = lit ? 90.0f : -90.0f,
                                                                      .elevation_deg = kElevation,
                                                                      .angle_deg = kRadius,
                                                                      .radiance = glm::vec3(kRadiance)}});
    show.environment.setMostKeys(4);
    show.move("body", kThere);
    ASSERT_EQ(show.environment.keys().size(), 1u);
    for (const float distance : {kNear, 0.12f, 0.25f})
      EXPECT_NEAR(seenBeside(show, kThere, distance), kSky * openBeside(distance) + (lit ? sun : 0.0f),
                  0.03f * kSky + (lit ? 0.01f * sun : 0.0f))
          << distance << " m beside it, " << (lit ? "in the sun" : "in its shadow");
  }
}

}  // namespace lambent
