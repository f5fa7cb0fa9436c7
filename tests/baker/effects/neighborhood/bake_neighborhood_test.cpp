// Tests whole neighborhoods: grids, points inside bodies, codes.
#include <random>

#include <gtest/gtest.h>

#include "baker/effects/neighborhood/bodies.hpp"
#include "baker/effects/neighborhood/neighborhood.hpp"
#include "baker/jobs/parallel.hpp"
#include "baker/jobs/progress.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/neighborhood.hpp"

namespace lambent::baker {

namespace {

using testing::blackSphereChange;
using testing::ChangeMatrix;
using testing::DecodedNeighborhood;
using testing::icosphere;
using testing::irradianceOf;
using testing::matrixOf;
using testing::sceneOf;
using testing::Transport;

// Makes a body with receivers below it or on all sides.
struct Made : testing::BakedBody {
  explicit Made(const bundle::MeshData& mesh, const glm::vec3& albedo = glm::vec3(0.0f))
      : BakedBody(mesh, albedo) {
    settings.placement.body = {transport.geometry.bounds_min, transport.geometry.bounds_max};
    settings.rays = 512;
    settings.placement.by_length = {16, 16, 8};
  }
  BakedAround bake() const {
    Progress progress;
    auto result = bakeNeighborhood(body, settings, {progress});
    EXPECT_TRUE(result.has_value());
    return std::move(*result);
  }
  NeighborhoodSettings settings;
};

TEST(Neighborhood, OfABlackSphereHoldsTheClosedFormAtItsPointsAfterCoding) {
  for (const bool matrices : {false, true}) {
    Made made(icosphere({0, 0, 0}, 1.0f, 4));
    made.settings.rays = 2048;
    made.settings.matrices = matrices;
    made.settings.placement.receivers = Box3{{-20, -3, -20}, {20, -1.2f, 20}};
    const BakedAround around = made.bake();
    ASSERT_TRUE(around.grid.has_value());
    EXPECT_LE(around.figures.change_error, 0.05);
    const DecodedNeighborhood grid(*around.grid);
    const int order_out = grid.shape().order_out;
    EXPECT_EQ(order_out, matrices ? 5 : 3);
    std::size_t changed = 0, worse = 0;
    for (std::size_t p = 0; p < grid.placement().count(); ++p) {
      const glm::vec3 point = grid.placement().point(p);
      if (glm::length(point) < 1.0f) continue;
      const ChangeMatrix truth = blackSphereChange(point, 1.0f, 5, order_out);
      ChangeMatrix wrong = matrixOf(grid.shape(), grid.visibility(p), {});
      for (std::size_t i = 0; i < wrong.size(); ++i) wrong[i] -= truth[i];
      const double error = irradianceOf(wrong, 5, order_out), change = irradianceOf(truth, 5, order_out);
      EXPECT_LT(error, 0.005) << p;
      if (change < 0.02) continue;
      ++changed;
      worse += !(error <= 0.05 * change);
    }
    EXPECT_GT(changed, 100u);
    EXPECT_LE(worse, changed / 50);  // 99 in 100 are asked of the coding
  }
}

TEST(Neighborhood, IsCloserBetweenItsPointsWhereTheyHoldWhatInterpolatesBest) {
  Made made(icosphere({0, 0, 0}, 1.0f, 3));
  made.settings.placement.receivers = Box3{{-20, -3, -20}, {20, -1.3f, 20}};
  made.settings.placement.by_length = {24, 24, 6};
  const auto errorOf = [&](bool fit) {
    made.settings.fit_between_points = fit;
    const DecodedNeighborhood grid(*made.bake().grid);
    const auto truth = [](const glm::vec3& p) { return blackSphereChange(p, 1.0f, 5, 3); };
    return testing::errorsAgainst(grid, made.settings.placement.receivers, 2000, truth).rms;
  };
  const double without = errorOf(false);
  EXPECT_GT(without, 1e-3);
  EXPECT_LT(errorOf(true), 0.7 * without);
}

TEST(Neighborhood, IsRightAtTheBodysSurfaceAlthoughPointsLieInside) {
  // Points inside are dark, and interpolation reaches for them. Close to the surface, all around.
  Made made(icosphere({0, 0, 0}, 1.0f, 4));
  made.settings.rays = 1024;
  made.settings.placement.extent = glm::vec3(4.0f);
  made.settings.placement.by_length = glm::uvec3(17);  // a spacing of a quarter of the radius
  const BakedAround around = made.bake();
  ASSERT_TRUE(around.grid.has_value());
  EXPECT_GT(around.figures.inside_points, 100u);
  const DecodedNeighborhood grid(*around.grid);
  double continued = 0.0, dark = 0.0;
  int count = 0;
  const ChangeMatrix darkness = [] {
    ChangeMatrix m(9 * 25, 0.0f);
    for (std::size_t i = 0; i < 9; ++i) m[i * 25 + i] = -1.0f;
    return m;
  }();
  for (int i = 0; i < 200; ++i) {
    const float z = 1.0f - 2.0f * (static_cast<float>(i) + 0.5f) / 200.0f,
                phi = 2.39996f * static_cast<float>(i);
    const float r = std::sqrt(1.0f - z * z);
    const glm::vec3 point = 1.02f * glm::vec3(r * std::cos(phi), r * std::sin(phi), z);
    const ChangeMatrix truth = blackSphereChange(point, 1.0f, 5, 3);
    ChangeMatrix wrong = grid.at(point), half = darkness;
    for (std::size_t k = 0; k < wrong.size(); ++k) {
      wrong[k] -= truth[k];
      half[k] = 0.5f * (half[k] - truth[k]);  // what a dark point inside would do, at half weight
    }
    continued += std::pow(irradianceOf(wrong, 5, 3), 2);
    dark += std::pow(irradianceOf(half, 5, 3), 2);
    ++count;
  }
  EXPECT_LT(std::sqrt(continued / count), 0.08);
  EXPECT_GT(std::sqrt(dark / count), 0.3);
}

TEST(Neighborhood, FadesToNothingAtFacesThatNoReceiverSet) {
  Made made(icosphere({0, 0, 0}, 1.0f, 3), {0.8f, 0.6f, 0.4f});
  const BakedAround around = made.bake();
  ASSERT_TRUE(around.grid.has_value());
  const DecodedNeighborhood grid(*around.grid);
  EXPECT_EQ(grid.shape().channels, 3u);
  const ChangeMeter meter(grid.shape());
  const glm::uvec3 size = grid.placement().size;
  double largest = 0.0;
  for (std::size_t p = 0; p < grid.placement().count(); ++p) {
    const glm::uvec3 at(p % size.x, p / size.x % size.y, p / (size.x * size.y));
    bool face = false;
    for (int axis = 0; axis < 3; ++axis) face = face || at[axis] == 0 || at[axis] + 1 == size[axis];
    const double change = meter.measure(grid.visibility(p), grid.bounced(p));
    if (face) {
      EXPECT_LT(change, 0.012) << p;
    }
    largest = testing::larger(largest, change);
  }
  EXPECT_GT(largest, 0.05);
}

TEST(Neighborhood, DecodesBothPartsWithinTheBound) {
  Made made(icosphere({0, 0, 0}, 1.0f, 3), {0.9f, 0.5f, 0.2f});
  made.settings.placement.receivers = Box3{{-20, -3, -20}, {20, -1.2f, 20}};
  const BakedAround around = made.bake();
  ASSERT_TRUE(around.grid.has_value());
  ASSERT_EQ(around.grid->cells.size(), 1u);
  ASSERT_EQ(around.grid->cells[0].transfers.size(), 2u);
  const transfer::TransferShape &visibility = around.grid->cells[0].transfers[0].shape,
                                &bounced = around.grid->cells[0].transfers[1].shape;
  EXPECT_EQ(visibility.visibility_bands, 7u);
  EXPECT_EQ(visibility.outputs, 9u);
  EXPECT_EQ(bounced.shadowed_channels, 0u);
  EXPECT_EQ(bounced.full_channels, 3u);
  EXPECT_EQ(bounced.outputs, 9u);

  const DecodedNeighborhood grid(*around.grid);
  Progress progress;
  const auto truth = changeOnGrid(made.body, grid.placement(), grid.shape(), made.settings.rays, {progress});
  const ChangeMeter meter(grid.shape());
  double square = 0.0;
  for (std::size_t p = 0; p < grid.placement().count(); ++p) {
    std::vector<float> v(grid.visibility(p).begin(), grid.visibility(p).end()),
        b(grid.bounced(p).begin(), grid.bounced(p).end());
    for (std::size_t i = 0; i < v.size(); ++i) v[i] -= truth->visibility[p * v.size() + i];
    for (std::size_t i = 0; i < b.size(); ++i) b[i] -= truth->bounced[p * b.size() + i];
    square += std::pow(meter.measure(v, b), 2);
  }
  const double error = std::sqrt(square / static_cast<double>(grid.placement().count()));
  EXPECT_LE(error, 1.1 * made.settings.coding.bound);
  EXPECT_NEAR(error, around.figures.error, 0.3 * around.figures.error);
}

TEST(Neighborhood, IsTheSameOnOneThreadAndOnTwo) {
  Made made(icosphere({0, 0, 0}, 1.0f, 2), {0.9f, 0.5f, 0.2f});
  made.settings.placement.by_length = {8, 8, 8};
  made.settings.rays = 128;
  std::vector<std::byte> first;
  for (const unsigned threads : {1u, 2u}) {
    std::optional<BakedAround> around;
    withThreads(threads, [&] { around = made.bake(); });
    ByteWriter out;
    write(*around, out);
    const std::vector<std::byte> bytes = out.take();
    if (threads == 1)
      first = bytes;
    else
      EXPECT_EQ(bytes, first);
  }
  EXPECT_GT(first.size(), 100u);
}

TEST(Neighborhood, OfOneTriangleIsFinite) {
  bundle::MeshData triangle;
  triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, -1}};
  triangle.normals.assign(3, {0, 1, 0});
  triangle.indices = {0, 1, 2};
  Made made(triangle, glm::vec3(0.5f));
  made.settings.placement.by_length = {9, 9, 9};
  const BakedAround around = made.bake();
  ASSERT_TRUE(around.grid.has_value());
  const DecodedNeighborhood grid(*around.grid);
  const ChangeMeter meter(grid.shape());
  for (std::size_t p = 0; p < grid.placement().count(); ++p) {
    const double change = meter.measure(grid.visibility(p), grid.bounced(p));
    EXPECT_TRUE(std::isfinite(change));
    EXPECT_LT(change, 2.0);
  }
}

TEST(Neighborhood, OfNoSizeIsNone) {
  bundle::MeshData point;
  point.positions.assign(3, {2, 2, 2});
  point.normals.assign(3, {0, 1, 0});
  point.indices = {0, 1, 2};
  EXPECT_FALSE(Made(point).bake().grid.has_value());
}

TEST(Neighborhood, StopsWhenAsked) {
  const Made made(icosphere({0, 0, 0}, 1.0f, 2));
  std::stop_source stop;
  stop.request_stop();
  Progress progress;
  EXPECT_FALSE(bakeNeighborhood(made.body, made.settings, {progress, stop.get_token()}).has_value());
}

// Tests how the change around a body is coded within a limit of bytes.

// Bounced light in which noise of few rays takes as many components as there are values.
GridChange noisyChange(const GridPlacement& grid) {
  GridChange change;
  change.shape = {.order = 5, .order_out = 5, .channels = 1};
  std::mt19937 random(7);
  std::normal_distribution<float> noise(0.0f, 1e-3f);
  const std::size_t size = change.shape.bouncedSize();
  change.visibility.assign(grid.count() * change.shape.visibilitySize(), 0.0f);
  change.outside.assign(grid.count(), 1);
  for (std::size_t p = 0; p < grid.count(); ++p)
    for (std::size_t i = 0; i < size; ++i) {
      const float near = 1.0f / (1.0f + glm::length(grid.point(p)));
      change.bounced.push_back((i == 0 ? 0.5f * near : 0.0f) + near * noise(random));
    }
  return change;
}

// Returns the bytes of a point's codes before compression, which makes noise little smaller.
double codeBytes(const CodedChange& change, const GridPlacement& grid) {
  double bytes = 0.0;
  for (const CodedCell& cell : change.cells)
    for (const CodedTransfer& part : cell.transfers)
      for (const CodedPlane& plane : part.planes)
        bytes += static_cast<double>(plane.codes.size() * plane.bits / 8);
  return bytes / static_cast<double>(grid.count());
}

TEST(CodedChange, OfNoiseThatComponentsDoNotHoldKeepsTheLimitOfBytesAndUsesIt) {
  constexpr double kLimit = 43.0, kCompression = 1.5;
  const GridPlacement grid{.size = {16, 8, 16}, .box = {glm::vec3(-2.0f), glm::vec3(2.0f)}};
  const GridChange change = noisyChange(grid);
  Progress progress;
  CachedCoding coding(BakeContext{progress});
  const auto code = [&](double most_bytes) {
    return codeChange(change, grid, glm::vec3(0.0f), {.bound = 1e-5, .most_bytes = most_bytes}, coding,
                      progress);
  };
  const auto all = code(1e9), limited = code(kLimit);
  ASSERT_TRUE(all && limited);
  EXPECT_GT(codeBytes(*all, grid), 2.0 * kLimit);
  EXPECT_LT(codeBytes(*limited, grid), kCompression * kLimit);
  EXPECT_GT(codeBytes(*limited, grid), 0.3 * kLimit);
  EXPECT_LT(limited->error, 3.0 * all->error);
}

}  // namespace
}  // namespace lambent::baker
