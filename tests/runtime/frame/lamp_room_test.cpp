// Rooms with lamps in them, on the CPU: known answers, and what costs nothing.
#include "runtime/frame/lamp_room.hpp"

#include <cmath>
#include <cstring>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "runtime/frame/lamp_light.hpp"
#include "tests/runtime/lighting/rooms.hpp"

namespace lambent::frame {

using lighting::NearLight;
using lighting::Patch;
using lighting::PatchTransport;
using testing::RoomBuilder;

namespace {

constexpr float kPi = std::numbers::pi_v<float>;

NearLight pointLamp(glm::vec3 position, glm::vec3 power = glm::vec3(1.0f)) {
  NearLight light;
  light.position_ws = position;
  light.power = power;
  return light;
}

LampRoom boxRoom(float albedo = 0.5f) {
  return LampRoom(std::make_shared<const PatchTransport>(
      RoomBuilder().box({0, 0, 0}, {2, 2.4f, 3}, glm::vec3(albedo)).proxy()));
}

void shine(LampRoom& room, std::vector<NearLight> lamps,
           const std::vector<lighting::RayTriangle>& others = {}) {
  room.light(lamps, glm::mat4(1.0f), others);
}

bool sameBytes(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(glm::vec3)) == 0;
}

// Flux that arrives at all patches, over that of the lamp.
double received(const lighting::Patches& patches, const std::vector<float>& direct, double flux) {
  double sum = 0.0;
  for (std::size_t i = 0; i < patches.size(); ++i)
    sum += double{patches.all()[i].area} * direct[i] * std::numbers::pi;
  return sum / flux;
}

}  // namespace

TEST(LampLight, AllLightOfALampArrivesInAClosedRoom) {
  const lighting::Patches patches(RoomBuilder().box({0, 0, 0}, {2, 2.4f, 3}, glm::vec3(0.5f)).proxy());
  NearLight point = pointLamp({0.8f, 1.3f, 1.1f});
  EXPECT_NEAR(received(patches, lampOnPatches(point, patches, {}, glm::mat4(1.0f)), 4.0 * kPi), 1.0, 0.01);
  NearLight sphere = point;
  sphere.kind = NearLight::Kind::Sphere;
  sphere.radius_m = 0.3f;  // flux pi L 4 pi r²
  EXPECT_NEAR(received(patches, lampOnPatches(sphere, patches, {}, glm::mat4(1.0f)), kPi * 4.0 * kPi * 0.09),
              1.0, 0.01);
  NearLight disc = sphere;
  disc.kind = NearLight::Kind::Disc;
  disc.direction_ws = {0, -2, 0};  // of any length
  EXPECT_NEAR(received(patches, lampOnPatches(disc, patches, {}, glm::mat4(1.0f)), kPi * kPi * 0.09), 1.0,
              0.01);
  NearLight spot = point;
  spot.kind = NearLight::Kind::Spot;
  spot.direction_ws = {1, 0, 0};
  const std::vector<float> ahead = lampOnPatches(spot, patches, {}, glm::mat4(1.0f));
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (patches.all()[i].points[0].x >= 0.7f) continue;
    ASSERT_EQ(ahead[i], 0.0f) << i;
  }
}

TEST(LampLight, ALampInABoxLightsNothingOfTheBoxBeside) {
  const lighting::Patches patches(RoomBuilder()
                                      .box({0, 0, 0}, {1, 1, 1}, glm::vec3(0.7f))
                                      .box({1.1f, 0, 0}, {2, 1, 1}, glm::vec3(0.7f))
                                      .proxy());
  NearLight lamp = pointLamp({0.5f, 0.5f, 0.5f});
  lamp.kind = NearLight::Kind::Sphere;
  lamp.radius_m = 0.2f;
  const std::vector<float> direct = lampOnPatches(lamp, patches, {}, glm::mat4(1.0f));
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const bool beside = patches.all()[i].points[0].x > 1.05f;
    ASSERT_EQ(direct[i] == 0.0f, beside) << i;
  }
}

TEST(LampLight, WhatIsNoLargerThanTheLampAndWithinItCastsNoShadow) {
  RoomBuilder builder;
  builder.wall({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, glm::vec3(0.5f));  // a floor
  const lighting::Patches patches(builder.proxy());
  NearLight bulb = pointLamp({0, 1, 0});
  bulb.kind = NearLight::Kind::Sphere;
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

TEST(LampRoom, WhatARoomSendsOnIsAlbedoOverOneMinusAlbedoOfTheLamp) {
  for (const float albedo : {0.3f, 0.7f}) {
    LampRoom room = boxRoom(albedo);
    shine(room, {pointLamp({1, 1.2f, 1.5f})});
    double flux = 0.0;
    const auto& patches = room.transport()->patches().all();
    for (std::size_t i = 0; i < patches.size(); ++i)
      flux += std::numbers::pi * patches[i].area * room.givenOff()[i].g;
    EXPECT_NEAR(flux / (4.0 * kPi) / (albedo / (1.0 - albedo)), 1.0, 0.03);
  }
}

TEST(LampRoom, DimmingIsLinearToTheBitAndBouncesNothingAnew) {
  LampRoom room = boxRoom();
  shine(room, {pointLamp({1, 2, 1}, {4, 2, 1})});
  EXPECT_EQ(room.bouncedLast(), 1u);
  const std::vector<glm::vec3> full = room.givenOff();
  const std::uint64_t version = room.version();
  shine(room, {pointLamp({1, 2, 1}, {1, 0.5f, 0.25f})});
  EXPECT_EQ(room.bouncedLast(), 0u);
  EXPECT_GT(room.version(), version);
  for (std::size_t i = 0; i < full.size(); ++i) ASSERT_EQ(room.givenOff()[i], 0.25f * full[i]);
}

TEST(LampRoom, TwoLampsGiveTheSumOfBoth) {
  LampRoom room = boxRoom(), first = boxRoom(), second = boxRoom();
  const NearLight a = pointLamp({1, 2, 1}, {4, 2, 1}), b = pointLamp({0.3f, 1, 2.6f}, {1, 3, 5});
  shine(room, {a, b});
  shine(first, {a});
  shine(second, {b});
  for (std::size_t i = 0; i < room.givenOff().size(); ++i)
    for (int k = 0; k < 3; ++k)
      ASSERT_FLOAT_EQ(room.givenOff()[i][k], first.givenOff()[i][k] + second.givenOff()[i][k]);
}

TEST(LampRoom, WhatStandsStillIsNewOnlyOnce) {
  LampRoom room = boxRoom();
  const std::vector<NearLight> lamps = {pointLamp({1, 2, 1}), pointLamp({0.5f, 0.5f, 0.5f})};
  shine(room, lamps);
  const std::uint64_t version = room.version();
  shine(room, lamps);
  EXPECT_EQ(room.version(), version);
  EXPECT_EQ(room.bouncedLast(), 0u);
  // The other is switched off: what stays is not bounced anew.
  shine(room, {lamps[1]});
  EXPECT_EQ(room.bouncedLast(), 0u);
  EXPECT_GT(room.version(), version);
}

TEST(LampRoom, SwitchedOffItSendsOnNothing) {
  LampRoom room = boxRoom();
  shine(room, {pointLamp({1, 2, 1})});
  EXPECT_FALSE(room.givenOff().empty());
  shine(room, {});
  EXPECT_TRUE(room.givenOff().empty());
}

TEST(LampRoom, ALampThatComesBackGivesTheSameBytes) {
  LampRoom room = boxRoom();
  shine(room, {pointLamp({1, 2, 1})});
  const std::vector<glm::vec3> before = room.givenOff();
  shine(room, {pointLamp({1, 2, 1.1f})});
  EXPECT_EQ(room.bouncedLast(), 1u);
  EXPECT_FALSE(sameBytes(before, room.givenOff()));
  shine(room, {pointLamp({1, 2, 1})});
  EXPECT_TRUE(sameBytes(before, room.givenOff()));
}

TEST(LampRoom, WhatElseStandsInTheLightTakesItAway) {
  LampRoom room = boxRoom();
  shine(room, {pointLamp({1, 2.3f, 1.5f})});
  const std::vector<glm::vec3> open = room.givenOff();
  // A lid right below the lamp.
  const std::vector<lighting::RayTriangle> lid = {
      {.corners = {glm::vec3(-3, 2.2f, -3), glm::vec3(-3, 2.2f, 9), glm::vec3(9, 2.2f, -3)}}};
  shine(room, {pointLamp({1, 2.3f, 1.5f})}, lid);
  EXPECT_EQ(room.bouncedLast(), 1u);
  double before = 0.0, after = 0.0;
  const auto& patches = room.transport()->patches().all();
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (patches[i].normal.y < 0.5f) continue;  // the floor
    before += open[i].g;
    after += room.givenOff()[i].g;
  }
  EXPECT_LT(after, 0.6 * before) << "what the ceiling sends on passes the lid, which is no part of the room";
  shine(room, {pointLamp({1, 2.3f, 1.5f})}, lid);
  EXPECT_EQ(room.bouncedLast(), 0u);
}

TEST(LampRoom, ATurnedAndScaledRoomTakesTheSameShareOfLight) {
  LampRoom plain = boxRoom(), placed = boxRoom();
  shine(plain, {pointLamp({1, 2, 1})});
  // Twice the size: a quarter of the irradiance.
  const glm::mat4 world_from_group = glm::translate(glm::mat4(1.0f), glm::vec3(3, -1, 2)) *
                                     glm::rotate(glm::mat4(1.0f), 0.7f, glm::normalize(glm::vec3(1, 2, 3))) *
                                     glm::scale(glm::mat4(1.0f), glm::vec3(2.0f));
  const std::vector<NearLight> lamp = {pointLamp(glm::vec3(world_from_group * glm::vec4(1, 2, 1, 1)))};
  placed.light(lamp, world_from_group, {});
  for (std::size_t i = 0; i < plain.givenOff().size(); ++i)
    ASSERT_NEAR(4.0f * placed.givenOff()[i].r, plain.givenOff()[i].r, 0.02f * plain.givenOff()[i].r);
}

}  // namespace lambent::frame
