#include "runtime/lighting/patch_transport.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "runtime/sh/zonal.hpp"
#include "tests/runtime/lighting/rooms.hpp"

namespace lambent::lighting {

using testing::grey;
using testing::RoomBuilder;

namespace {

// Returns E/pi from an unoccluded point light of one candela.
std::vector<float> litFrom(const Patches& patches, const glm::vec3& light) {
  std::vector<float> direct;
  for (const Patch& patch : patches.all()) {
    float sum = 0.0f;
    for (const glm::vec3& point : patch.points) {
      const glm::vec3 to = light - point;
      const float d2 = glm::dot(to, to);
      sum += std::max(glm::dot(to, patch.normal), 0.0f) / (d2 * std::sqrt(d2)) / std::numbers::pi_v<float>;
    }
    direct.push_back(sum / static_cast<float>(kPatchPoints));
  }
  return direct;
}

double wholeOf(const Patches& patches, const std::vector<float>& received) {
  double sum = 0.0;
  for (std::size_t i = 0; i < patches.size(); ++i) sum += double{patches.all()[i].area} * received[i];
  return sum;
}

// Returns E/pi at all patches after bounces, from the light that they emit.
std::vector<float> receivedAll(const Patches& patches, const std::vector<glm::vec3>& given_off) {
  std::vector<float> received;
  for (std::size_t i = 0; i < patches.size(); ++i)
    received.push_back(given_off[i].r / patches.all()[i].albedo.r);
  return received;
}

glm::vec3 gathered(const PatchTransport& transport, const std::vector<std::uint16_t>& links,
                   std::size_t point, const std::vector<glm::vec3>& by_patch) {
  const std::vector<glm::vec3> given_off = transport.regions().means(by_patch);
  glm::vec3 sum(0.0f);
  for (std::size_t k = 0; k < kLinks; ++k)
    if (const std::uint16_t patch = links[kLinks * point + k]; patch < given_off.size())
      sum += given_off[patch];
  return sum / static_cast<float>(kLinks);
}

}  // namespace

TEST(PatchTransport, InAClosedSphereBouncesAddAlbedoOverOneMinusAlbedo) {
  for (const float albedo : {0.2f, 0.5f, 0.8f}) {
    const PatchTransport transport(RoomBuilder().sphere(10, 14, glm::vec3(albedo)).proxy());
    const Patches& patches = transport.patches();
    const std::vector<float> direct = litFrom(patches, {0, 0, 0});
    const std::vector<float> all = receivedAll(patches, transport.bounce(grey(direct)));
    const double ratio = wholeOf(patches, all) / wholeOf(patches, direct) - 1.0;
    EXPECT_NEAR(ratio / (albedo / (1.0 - albedo)), 1.0, 0.01) << albedo;
    for (std::size_t i = 0; i < all.size(); ++i)
      ASSERT_NEAR((all[i] - direct[i]) / direct[i], albedo / (1.0f - albedo),
                  0.05f * albedo / (1.0f - albedo))
          << i;
  }
}

TEST(PatchTransport, BouncesKeepTheColoursOfTheWalls) {
  RoomBuilder room;
  room.wall({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 1, 1});     // floor, facing up
  room.wall({0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.8f, 0, 0});  // a red wall that faces it
  const PatchTransport transport(room.proxy());
  const Patches& patches = transport.patches();
  std::vector<float> direct(patches.size());
  for (std::size_t i = 0; i < patches.size(); ++i) direct[i] = patches.all()[i].normal.x > 0.5f ? 1.0f : 0.0f;
  const auto given_off = transport.bounce(grey(direct));
  const std::vector<SurfacePoint> points = {{{0.05f, 0, 0.5f}, {0, 1, 0}}, {{0.9f, 0, 0.5f}, {0, 1, 0}}};
  const auto links = transport.link(points, LinkSpread::Cosine);
  const glm::vec3 near = gathered(transport, links, 0, given_off),
                  far = gathered(transport, links, 1, given_off);
  EXPECT_GT(near.r, 2.0f * far.r);
  EXPECT_EQ(near.g, 0.0f);
  EXPECT_GT(far.r, 0.0f);
}

TEST(PatchTransport, AtTheFootOfAWallHalfOfWhatIsSeenIsTheWall) {
  RoomBuilder room;
  room.wall({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, {1, 1, 1});
  room.wall({0, 0, 0}, {0, 4, 0}, {0, 0, 4}, {1, 1, 1});
  const PatchTransport transport(room.proxy());
  const Patches& patches = transport.patches();
  std::vector<glm::vec3> given_off(patches.size(), glm::vec3(0.0f));
  for (std::size_t i = 0; i < patches.size(); ++i)
    if (patches.all()[i].normal.x > 0.5f) given_off[i] = glm::vec3(1.0f);
  // Vertices lie on the edge itself, or by rounding behind it.
  for (const float x : {-0.004f, 0.0f, 0.001f}) {
    const std::vector<SurfacePoint> points = {{{x, -0.002f, 2}, {0, 1, 0}}};
    EXPECT_NEAR(gathered(transport, transport.link(points, LinkSpread::Cosine), 0, given_off).r, 0.5f, 0.04f)
        << x;
  }
}

TEST(PatchTransport, NothingGoesThroughAWallToTheBoxBeside) {
  RoomBuilder room;
  room.box({0, 0, 0}, {1, 1, 1}, glm::vec3(0.7f)).box({1, 0, 0}, {2, 1, 1}, glm::vec3(0.7f));
  const PatchTransport transport(room.proxy());
  const Patches& patches = transport.patches();
  std::vector<float> direct = litFrom(patches, {0.5f, 0.5f, 0.5f});
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const Patch& patch = patches.all()[i];
    const bool beside = patch.points[0].x > 1.0001f || (patch.points[0].x > 0.9999f && patch.normal.x > 0.5f);
    if (beside) direct[i] = 0.0f;
  }
  const auto given_off = transport.bounce(grey(direct));
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (direct[i] != 0.0f) continue;
    ASSERT_EQ(given_off[i], glm::vec3(0.0f)) << i;
  }
}

TEST(Patches, APointOfAThinBarStaysBesideItHoweverFarPatchesAreFromOtherSurfaces) {
  // The error is that of the worst place of a group: three times as wide as the bar.
  constexpr float kHalf = 0.05f;
  RoomBuilder room;
  room.wall({-2, -1, 2}, {4, 0, 0}, {0, 0, -4}, glm::vec3(0.5f));
  const glm::vec3 along(2, 0, 0), up(0, 2.0f * kHalf, 0), deep(0, 0, 2.0f * kHalf), low(-1, -kHalf, -kHalf);
  room.wall(low + deep, along, up, glm::vec3(0.5f)).wall(low, up, along, glm::vec3(0.5f));
  room.wall(low, along, deep, glm::vec3(0.5f)).wall(low + up, deep, along, glm::vec3(0.5f));
  bundle::CaptureProxy proxy = room.proxy();
  proxy.levels[0].error_m = 6.0f * kHalf;
  const Patches patches(bundle::patchSurfaceOf(proxy), 64);
  for (const float x : {-0.8f, 0.0f, 0.7f})
    for (const float y : {-0.9f, 0.0f, 0.9f}) {
      const glm::vec3 point(x, y * kHalf, kHalf), normal(0, 0, 1);
      EXPECT_LT(glm::distance(patches.inFront(point, normal), point), 0.002f * patches.extent())
          << x << " " << y;
      EXPECT_GT(patches.inFront(point, normal).z, kHalf);
    }
}

TEST(Patches, APointALittleBehindItsPatchComesInFrontOfIt) {
  RoomBuilder room;
  room.wall({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, glm::vec3(0.5f));
  bundle::CaptureProxy proxy = room.proxy();
  proxy.levels[0].error_m = 0.1f;
  const Patches patches(bundle::patchSurfaceOf(proxy), 64);
  EXPECT_GT(patches.inFront({0.3f, -0.09f, 0.2f}, {0, 1, 0}).y, 0.0f);
  EXPECT_LT(patches.inFront({0.3f, -0.3f, 0.2f}, {0, 1, 0}).y, -0.29f) << "that is another surface";
}

TEST(PatchTransport, AnOpenPatchHasTheClosedFormOfItsDirectTransfer) {
  const glm::vec3 normal = glm::normalize(glm::vec3(1, 2, 3));
  const LinkFrame frame = linkFrame(normal);
  const PatchTransport transport(RoomBuilder().wall({0, 0, 0}, frame.x, frame.y, {1, 1, 1}).proxy(), 8, 4);
  std::vector<float> expected(16);
  sh::unoccludedTransfer(4, normal, expected);
  for (std::size_t c = 0; c < 16; ++c) {
    std::vector<glm::vec4> light(16, glm::vec4(0.0f));
    light[c] = glm::vec4(1, 2, 3, 0);
    EXPECT_NEAR(transport.direct(0, light).y, 2.0f * expected[c], 1e-6f) << c;
  }
  EXPECT_EQ(transport.bounced(), 0.0f);
}

TEST(PatchTransport, ASmallBrightSpotIsMissedFromNowhere) {
  RoomBuilder room;
  room.wall({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, glm::vec3(0.5f));
  const PatchTransport transport(room.proxy());
  const Patches& patches = transport.patches();
  std::vector<glm::vec3> given_off(patches.size(), glm::vec3(0.0f));
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const glm::vec3 middle = patches.all()[i].points[0];
    if (std::abs(middle.x - 0.4f) < 0.3f && std::abs(middle.z) < 0.3f) given_off[i] = glm::vec3(1.0f);
  }
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 25; ++i)
    points.push_back(
        {{-1.0f + 0.5f * static_cast<float>(i % 5), 2.0f, -1.0f + 0.5f * static_cast<float>(i / 5)},
         {0, -1, 0}});
  const auto links = transport.link(points, LinkSpread::Cosine);
  double error = 0.0, power = 0.0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    double expected = 0.0;
    for (std::size_t i = 0; i < patches.size(); ++i)
      for (const glm::vec3& point : patches.all()[i].points) {
        const glm::vec3 way = point - points[p].position;
        const double d2 = glm::dot(way, way);
        expected += double{given_off[i].r} * 4.0 / (std::numbers::pi_v<float> * d2 * d2) *
                    patches.all()[i].area / kPatchPoints;
      }
    const double found = gathered(transport, links, p, given_off).r;
    EXPECT_NEAR(found / expected, 1.0, 0.55) << p;
    error += (found - expected) * (found - expected);
    power += expected * expected;
  }
  EXPECT_LT(std::sqrt(error / power), 0.25);  // 0.55 where links go to single patches
}

TEST(PatchTransport, ADarkBoxOnALitFloorStaysDark) {
  RoomBuilder room;
  room.wall({-4, 0, 4}, {8, 0, 0}, {0, 0, -8}, glm::vec3(0.5f));  // goes on under the box
  room.box({0.3f, 0, 0.3f}, {1.3f, 1, 1.3f}, glm::vec3(0.5f));
  const PatchTransport transport(room.proxy());
  const Patches& patches = transport.patches();
  const auto within = [](const glm::vec3& p) { return p.x > 0.1f && p.x < 1.5f && p.z > 0.1f && p.z < 1.5f; };
  std::vector<glm::vec3> given_off(patches.size(), glm::vec3(1.0f));
  for (std::size_t i = 0; i < patches.size(); ++i)
    if (within(patches.all()[i].points[0])) given_off[i] = glm::vec3(0.0f);
  const std::vector<SurfacePoint> points = {{{0.8f, 1, 0.8f}, {0, -1, 0}}, {{1.3f, 0.8f, 0.5f}, {-1, 0, 0}}};
  const auto links = transport.link(points, LinkSpread::Cosine);
  for (std::size_t p = 0; p < points.size(); ++p)
    EXPECT_EQ(gathered(transport, links, p, given_off).r, 0.0f) << p;
}

TEST(PatchRegions, HoldTheMeansOfTheirPatchesAndAllOfThemAtEachLevel) {
  const Patches patches(RoomBuilder().wall({0, 0, 0}, {3, 0, 0}, {0, 1, 0}, glm::vec3(0.5f)).surface(), 200);
  const PatchRegions regions(patches);
  std::vector<glm::vec3> values;
  for (const Patch& patch : patches.all()) values.push_back(patch.points[0]);
  const std::vector<glm::vec3> means = regions.means(values);
  ASSERT_EQ(means.size(), regions.size());
  for (std::size_t level = 0; level < regions.levelsOf(0); ++level) {
    const RayHit hit{.triangle = 0, .b = 0.3f, .c = 0.2f, .back = false};
    const auto corners = regions.cornersAt(hit, level);
    const glm::vec3 middle = (corners[0] + corners[1] + corners[2]) / 3.0f;
    const float size = std::sqrt(regions.areaOf(0, level));
    EXPECT_LT(glm::distance(means[regions.regionAt(hit, level)], middle), size) << level;
  }
  // The last level is the triangle itself.
  const RayHit anywhere{.triangle = 1, .b = 0.1f, .c = 0.1f, .back = false};
  const std::size_t whole = regions.regionAt(anywhere, regions.levelsOf(1) - 1);
  EXPECT_NEAR(regions.areaOf(1, regions.levelsOf(1) - 1), 1.5f, 1e-4f);
  EXPECT_NEAR(means[whole].x, 1.0f, 0.02f);
}

}  // namespace lambent::lighting
