#include "runtime/lighting/patch_transport.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>
#include <utility>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/lighting/triangle_tree.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/runtime/lighting/rooms.hpp"

namespace lambent::lighting {

// Tests that rays meet in a tree of triangles what they meet one triangle at a time.

namespace {

class Random {
 public:
  float between(float low, float high) { return std::uniform_real_distribution<float>(low, high)(source_); }
  glm::vec3 inBox(float half) { return {between(-half, half), between(-half, half), between(-half, half)}; }

 private:
  std::mt19937 source_{7};
};

std::vector<RayTriangle> manyTriangles(Random& random, std::size_t count) {
  std::vector<RayTriangle> triangles;
  for (std::size_t i = 0; i < count; ++i) {
    // A few large ones lie among the small ones, as walls among ornaments.
    const float size = i % 50 == 0 ? 2.0f : 0.1f;
    const glm::vec3 at = random.inBox(1.0f);
    triangles.push_back(
        {{at, at + random.inBox(size), at + random.inBox(size)}, random.between(0.0f, 1.0f) < 0.3f});
  }
  return triangles;
}

// Returns the nearest of all triangles, each met in a tree of its own, and its distance.
std::optional<std::pair<std::uint32_t, float>> nearestOf(const std::vector<RayTriangle>& triangles,
                                                         const glm::vec3& origin,
                                                         const glm::vec3& direction) {
  std::optional<std::pair<std::uint32_t, float>> nearest;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const auto hit = TriangleTree({triangles[i]}, 0.0f).first(origin, direction);
    if (!hit) continue;
    const auto& [a, b, c] = triangles[i].corners;
    const float distance = glm::distance(origin, a + hit->b * (b - a) + hit->c * (c - a));
    if (!nearest || distance < nearest->second) nearest = {i, distance};
  }
  return nearest;
}

TEST(TriangleTree, FindsTheNearestOfManyAsOneByOne) {
  Random random;
  const std::vector<RayTriangle> triangles = manyTriangles(random, 1000);
  const TriangleTree tree(triangles, 0.0f);
  std::size_t hits = 0;
  for (int i = 0; i < 400; ++i) {
    const glm::vec3 origin = random.inBox(1.5f), direction = random.inBox(1.0f);
    const auto expected = nearestOf(triangles, origin, direction);
    const auto found = tree.first(origin, direction);
    ASSERT_EQ(found.has_value(), expected.has_value()) << i;
    if (!found) continue;
    ++hits;
    EXPECT_EQ(found->triangle, expected->first) << i;
    const float lengths = expected->second / glm::length(direction);
    EXPECT_TRUE(tree.blocked(origin, direction, 1.001f * lengths)) << i;
    EXPECT_FALSE(tree.blocked(origin, direction, 0.999f * lengths)) << i;
  }
  EXPECT_GT(hits, 100u);
}

TEST(TriangleTree, LetsNoRayOutOfAClosedBoxAlongAxesAndThroughEdges) {
  std::vector<RayTriangle> box;
  constexpr int kCells = 6;  // along an edge
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f})
      for (int u = 0; u < kCells; ++u)
        for (int v = 0; v < kCells; ++v) {
          const auto corner = [&](int i, int j) {
            glm::vec3 p(side);
            p[(axis + 1) % 3] = 2.0f * static_cast<float>(i) / kCells - 1.0f;
            p[(axis + 2) % 3] = 2.0f * static_cast<float>(j) / kCells - 1.0f;
            return p;
          };
          box.push_back({{corner(u, v), corner(u + 1, v), corner(u + 1, v + 1)}});
          box.push_back({{corner(u, v), corner(u + 1, v + 1), corner(u, v + 1)}});
        }
  const TriangleTree tree(box, 0.0f);
  for (int x = -6; x <= 6; ++x)
    for (int y = -6; y <= 6; ++y)
      for (int z = -6; z <= 6; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        EXPECT_TRUE(tree.first(glm::vec3(0.0f), {x, y, z})) << x << ' ' << y << ' ' << z;
      }
}

TEST(TriangleTree, OfASheetsTwoSidesTheOneThatFacesTheRayCounts) {
  Random random;
  const glm::vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  const TriangleTree tree({{{a, b, c}}, {{a, c, b}}}, 1e-5f);
  for (int i = 0; i < 50; ++i) {
    const glm::vec3 at(random.between(0.1f, 0.4f), random.between(0.1f, 0.4f), 0.0f);
    for (const float side : {-1.0f, 1.0f}) {
      const glm::vec3 origin(random.between(0, 1), random.between(0, 1), side);
      const auto hit = tree.first(origin, at - origin);
      ASSERT_TRUE(hit);
      EXPECT_FALSE(hit->back);
      EXPECT_EQ(hit->triangle, side > 0.0f ? 0u : 1u);
    }
  }
  EXPECT_FALSE(tree.first({0.2f, 0.2f, 1e-6f}, {0, 0, -1}));  // it lies on the sheet
}

TEST(TriangleTree, FindsAllTrianglesNearAPoint) {
  Random random;
  const std::vector<RayTriangle> triangles = manyTriangles(random, 500);
  const TriangleTree tree(triangles, 0.0f);
  std::vector<std::uint32_t> found;
  for (int i = 0; i < 50; ++i) {
    const glm::vec3 point = random.inBox(1.0f);
    tree.findNear(point, 0.2f, found);
    EXPECT_TRUE(std::ranges::is_sorted(found));
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      const auto isNear = [&](const glm::vec3& corner) { return glm::distance(corner, point) < 0.2f; };
      if (std::ranges::none_of(triangles[t].corners, isNear)) continue;
      EXPECT_TRUE(std::ranges::binary_search(found, t)) << i << ' ' << t;
    }
  }
}

}  // namespace

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
  const std::vector<glm::vec3> given_off = transport.patches().means(by_patch);
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

TEST(Patches, RegionsHoldTheMeansOfTheirPatchesAndAllOfThemAtEachLevel) {
  const Patches patches(RoomBuilder().wall({0, 0, 0}, {3, 0, 0}, {0, 1, 0}, glm::vec3(0.5f)).surface(), 200);
  std::vector<glm::vec3> values;
  for (const Patch& patch : patches.all()) values.push_back(patch.points[0]);
  const std::vector<glm::vec3> means = patches.means(values);
  ASSERT_EQ(means.size(), patches.regionCount());
  for (std::size_t level = 0; level < patches.levelsOf(0); ++level) {
    const RayHit hit{.triangle = 0, .b = 0.3f, .c = 0.2f, .back = false};
    const auto corners = patches.cornersAt(hit, level);
    const glm::vec3 middle = (corners[0] + corners[1] + corners[2]) / 3.0f;
    const float size = std::sqrt(patches.areaOf(0, level));
    EXPECT_LT(glm::distance(means[patches.regionAt(hit, level)], middle), size) << level;
  }
  // The last level is the triangle itself.
  const RayHit anywhere{.triangle = 1, .b = 0.1f, .c = 0.1f, .back = false};
  const std::size_t whole = patches.regionAt(anywhere, patches.levelsOf(1) - 1);
  EXPECT_NEAR(patches.areaOf(1, patches.levelsOf(1) - 1), 1.5f, 1e-4f);
  EXPECT_NEAR(means[whole].x, 1.0f, 0.02f);
}

}  // namespace lambent::lighting
