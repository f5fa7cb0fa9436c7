// Tests lamps in rooms on the CPU: known answers, and what costs nothing.
#include "runtime/bounces/patch_room.hpp"

#include <cmath>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "tests/runtime/lighting/rooms.hpp"
#include "tests/support/glsl/glsl.hpp"

namespace lambent::frame {

using lighting::LocalLight;
using lighting::Patch;
using lighting::PatchTransport;
using testing::RoomBuilder;

namespace {

constexpr float kPi = std::numbers::pi_v<float>;

namespace text {
using namespace lambent::glsl;
struct PatchChange {
#include "as_cpp/patch_change.glsl"
};
}  // namespace text

TEST(ShareOfChange, OfKeyLightsIsWhatTransferKnowsOfWhatPatchesSee) {
  text::PatchChange rule;
  const glm::vec3 known(0.1f), more(5.0f), less(-5.0f);
  // A vertex of a ceiling that lies outside of its room sees ten times the light that arrives at the ceiling.
  EXPECT_NEAR(rule.shareOfChange(known, more, -1.0f), 0.1f, 1e-6f);
  EXPECT_NEAR(rule.shareOfChange(known, less, -1.0f), 0.1f, 1e-6f);
  EXPECT_EQ(rule.shareOfChange(known, more, -0.05f), 1.0f);
  // With lamps, what is added may be theirs.
  EXPECT_EQ(rule.shareOfChange(known, more, 1.0f), 1.0f);
  EXPECT_NEAR(rule.shareOfChange(known, less, 1.0f), 0.1f, 1e-6f);
}

LocalLight pointLamp(glm::vec3 position, glm::vec3 power = glm::vec3(1.0f)) {
  LocalLight light;
  light.position_ws = position;
  light.power = power;
  return light;
}

PatchRoom boxRoom(float albedo = 0.5f) {
  return PatchRoom(std::make_shared<const PatchTransport>(
      RoomBuilder().box({0, 0, 0}, {2, 2.4f, 3}, glm::vec3(albedo)).proxy()));
}

void shine(PatchRoom& room, std::vector<LocalLight> lamps,
           const std::vector<lighting::RayTriangle>& others = {}) {
  room.light({.lamps = std::move(lamps)}, glm::mat4(1.0f), others);
}

// Returns the flux that arrives at all patches, relative to that of the lamp.
double received(const lighting::Patches& patches, const std::vector<float>& direct, double flux) {
  double sum = 0.0;
  for (std::size_t i = 0; i < patches.size(); ++i)
    sum += double{patches.all()[i].area} * direct[i] * std::numbers::pi;
  return sum / flux;
}

}  // namespace

TEST(LampLight, AllLightOfALampArrivesInAClosedRoom) {
  const lighting::Patches patches(RoomBuilder().box({0, 0, 0}, {2, 2.4f, 3}, glm::vec3(0.5f)).surface());
  LocalLight point = pointLamp({0.8f, 1.3f, 1.1f});
  EXPECT_NEAR(received(patches, lampOnPatches(point, patches, {}, glm::mat4(1.0f)), 4.0 * kPi), 1.0, 0.01);
  LocalLight sphere = point;
  sphere.kind = LocalLight::Kind::Sphere;
  sphere.radius_m = 0.3f;  // flux pi L 4 pi r²
  EXPECT_NEAR(received(patches, lampOnPatches(sphere, patches, {}, glm::mat4(1.0f)), kPi * 4.0 * kPi * 0.09),
              1.0, 0.01);
  LocalLight disc = sphere;
  disc.kind = LocalLight::Kind::Disc;
  disc.direction_ws = {0, -2, 0};  // of any length
  EXPECT_NEAR(received(patches, lampOnPatches(disc, patches, {}, glm::mat4(1.0f)), kPi * kPi * 0.09), 1.0,
              0.01);
  LocalLight spot = point;
  spot.kind = LocalLight::Kind::Spot;
  spot.direction_ws = {1, 0, 0};
  const std::vector<float> ahead = lampOnPatches(spot, patches, {}, glm::mat4(1.0f));
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (patches.all()[i].points[0].x >= 0.7f) continue;
    ASSERT_EQ(ahead[i], 0.0f) << i;
  }
}

TEST(LampLight, WhatIsNoLargerThanTheLampAndWithinItCastsNoShadow) {
  RoomBuilder builder;
  builder.wall({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, glm::vec3(0.5f));  // a floor
  const lighting::Patches patches(builder.surface());
  LocalLight bulb = pointLamp({0, 1, 0});
  bulb.kind = LocalLight::Kind::Sphere;
  bulb.radius_m = 0.1f;
  const auto shadowBy = [&](float half) {
    const lighting::RayTriangle plate{.corners = {glm::vec3(-half, 0.95f, -half),
                                                  glm::vec3(half, 0.95f, -half), glm::vec3(0, 0.95f, half)}};
    return received(patches, lampOnPatches(bulb, patches, std::span(&plate, 1), glm::mat4(1.0f)), 1.0) /
           received(patches, lampOnPatches(bulb, patches, {}, glm::mat4(1.0f)), 1.0);
  };
  EXPECT_EQ(shadowBy(0.05f), 1.0);
  EXPECT_LT(shadowBy(0.5f), 0.5);
}

TEST(PatchRoom, WhatARoomSendsOnIsAlbedoOverOneMinusAlbedoOfTheLamp) {
  for (const float albedo : {0.3f, 0.7f}) {
    PatchRoom room = boxRoom(albedo);
    shine(room, {pointLamp({1, 1.2f, 1.5f})});
    double flux = 0.0;
    const auto& patches = room.transport()->patches().all();
    for (std::size_t i = 0; i < patches.size(); ++i)
      flux += std::numbers::pi * patches[i].area * room.givenOff()[i].g;
    EXPECT_NEAR(flux / (4.0 * kPi) / (albedo / (1.0 - albedo)), 1.0, 0.03);
  }
}

TEST(PatchRoom, DimmingIsLinearToTheBitAndTracesNothingAnew) {
  PatchRoom room = boxRoom();
  shine(room, {pointLamp({1, 2, 1}, {4, 2, 1})});
  EXPECT_EQ(room.tracedLast(), 1u);
  const std::vector<glm::vec3> full = room.givenOff();
  const std::uint64_t version = room.version();
  shine(room, {pointLamp({1, 2, 1}, {1, 0.5f, 0.25f})});
  EXPECT_EQ(room.tracedLast(), 0u);
  EXPECT_GT(room.version(), version);
  for (std::size_t i = 0; i < full.size(); ++i) ASSERT_EQ(room.givenOff()[i], 0.25f * full[i]);
}

TEST(PatchRoom, WhatElseStandsInTheLightTakesItAway) {
  PatchRoom room = boxRoom();
  shine(room, {pointLamp({1, 2.3f, 1.5f})});
  const std::vector<glm::vec3> open = room.givenOff();
  // A lid is right below the lamp.
  const std::vector<lighting::RayTriangle> lid = {
      {.corners = {glm::vec3(-3, 2.2f, -3), glm::vec3(-3, 2.2f, 9), glm::vec3(9, 2.2f, -3)}}};
  shine(room, {pointLamp({1, 2.3f, 1.5f})}, lid);
  EXPECT_EQ(room.tracedLast(), 1u);
  double before = 0.0, after = 0.0;
  const auto& patches = room.transport()->patches().all();
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (patches[i].normal.y < 0.5f) continue;  // the floor
    before += open[i].g;
    after += room.givenOff()[i].g;
  }
  EXPECT_LT(after, 0.6 * before) << "what the ceiling sends on passes the lid, which is no part of the room";
  shine(room, {pointLamp({1, 2.3f, 1.5f})}, lid);
  EXPECT_EQ(room.tracedLast(), 0u);
}

TEST(PatchRoom, ATurnedAndScaledRoomTakesTheSameShareOfLight) {
  PatchRoom plain = boxRoom(), placed = boxRoom();
  shine(plain, {pointLamp({1, 2, 1})});
  // At twice the size the irradiance is a quarter.
  const glm::mat4 world_from_group = glm::translate(glm::mat4(1.0f), glm::vec3(3, -1, 2)) *
                                     glm::rotate(glm::mat4(1.0f), 0.7f, glm::normalize(glm::vec3(1, 2, 3))) *
                                     glm::scale(glm::mat4(1.0f), glm::vec3(2.0f));
  const std::vector<LocalLight> lamp = {pointLamp(glm::vec3(world_from_group * glm::vec4(1, 2, 1, 1)))};
  placed.light({.lamps = lamp}, world_from_group, {});
  for (std::size_t i = 0; i < plain.givenOff().size(); ++i)
    ASSERT_NEAR(4.0f * placed.givenOff()[i].r, plain.givenOff()[i].r, 0.02f * plain.givenOff()[i].r);
}

namespace {

constexpr int kOrder = 5;

spec::Disc sunAt(const glm::vec3& direction, float radius_rad = 0.05f) {
  return {.direction = glm::normalize(direction),
          .radius_rad = radius_rad,
          .radiance = glm::vec3(10.0f, 5.0f, 2.0f)};
}

// Returns the part that transfer gets from key lights at an unoccluded light probe.
KeyBands bandsOf(const std::vector<spec::Disc>& keys, const glm::vec3& position) {
  KeyBands bands{.position = position, .keys = {}, .all = {}};
  for (const glm::vec3& c : spec::discVector(keys).c) bands.keys.emplace_back(c, 0.0f);
  bands.all = bands.keys;
  return bands;
}

// Returns what the patches emit by the first bands of a light.
std::vector<glm::vec3> givenOffByBands(const PatchTransport& transport, const KeyBands& bands) {
  std::vector<glm::vec3> direct;
  for (std::size_t i = 0; i < transport.patches().size(); ++i)
    direct.push_back(transport.direct(i, bands.keys));
  return transport.bounce(direct);
}

// Makes a room that is open on one side and lit through it.
PatchRoom openRoom() {
  RoomBuilder builder;
  builder.box({0, 0, 0}, {2, 2, 2}, glm::vec3(0.5f));
  bundle::CaptureProxy proxy = builder.proxy();
  proxy.triangles.resize(10);  // the last wall is the ceiling
  proxy.levels[0].triangle_count = 10;
  return PatchRoom(std::make_shared<const PatchTransport>(proxy, lighting::kMaxPatches, kOrder));
}

}  // namespace

TEST(PatchRoom, WithTheirBandsKeyLightsFallWhereTheirRaysDo) {
  PatchRoom room = openRoom();
  const std::vector<spec::Disc> keys = {sunAt({0, 0.8f, 0.6f})};
  const KeyBands bands = bandsOf(keys, {1, 1, 1});
  room.light({.keys = keys, .bands = {bands}}, glm::mat4(1.0f), {});
  const PatchTransport& transport = *room.transport();
  const std::vector<glm::vec3> by_bands = givenOffByBands(transport, bands);
  const std::vector<std::vector<float>> by_rays = keysOnPatches(keys, transport.patches(), {});
  const std::vector<glm::vec3> all = transport.bounce(testing::grey(by_rays[0]));
  double straight = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const lighting::Patch& patch = transport.patches().all()[i];
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(room.givenOff()[i][c] + by_bands[i][c], all[i][c] * keys[0].radiance[c], 1e-3f) << i;
    if (patch.normal.y > 0.9f || patch.normal.z > 0.9f)
      straight += double{patch.area} * by_rays[0][i];
    else
      EXPECT_LT(by_rays[0][i], 1e-4f) << "a wall that the sun does not reach";
  }
  // The light comes through an opening of 4 m² at a cosine of 0.8; E/pi = sin² cos. The four points of a
  // patch share 16 rays.
  const double sine = std::sin(0.05);
  EXPECT_NEAR(straight / (4.0 * 0.8 * sine * sine), 1.0, 0.015);
}

TEST(PatchRoom, InAClosedRoomKeyLightsAndTheirBandsLeaveNothing) {
  PatchRoom room = boxRoom(0.8f);
  const std::vector<spec::Disc> keys = {sunAt({0.3f, 0.6f, 0.8f}), sunAt({-1, 0.1f, 0.2f}, 0.3f)};
  room.light({.keys = keys, .bands = {bandsOf(keys, {1, 1, 1})}}, glm::mat4(1.0f), {});
  const double open = 10.0 * std::pow(std::sin(0.3), 2);
  for (const glm::vec3& radiance : room.givenOff()) ASSERT_NEAR(radiance.r, 0.0f, 0.05 * open);
}

TEST(PatchRoom, KeyLightsThatAreBlockedByOtherBodiesAreTakenOff) {
  PatchRoom room = openRoom();
  const std::vector<spec::Disc> keys = {sunAt({0, 0.8f, 0.6f})};
  const KeyBands bands = bandsOf(keys, {1, 1, 1});
  const lighting::RayTriangle lid{
      .corners = {glm::vec3(-20, 3, -20), glm::vec3(20, 3, -20), glm::vec3(0, 3, 40)}};
  room.light({.keys = keys, .bands = {bands}}, glm::mat4(1.0f), std::span(&lid, 1));
  const std::vector<glm::vec3> by_bands = givenOffByBands(*room.transport(), bands);
  for (std::size_t i = 0; i < by_bands.size(); ++i)
    ASSERT_NEAR(room.givenOff()[i].g + by_bands[i].g, 0.0f, 1e-4f) << i;
}

}  // namespace lambent::frame
