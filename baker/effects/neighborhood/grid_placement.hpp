// Places the points of a neighborhood grid: around the body as far as it changes the light by more than a
// bound, and no farther than receivers come. If receivers are only below, the grid is a slab below the body.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include <glm/ext/vector_bool3.hpp>
#include <glm/vec3.hpp>

namespace lambent::baker {

struct Box3 {
  glm::vec3 low{0.0f}, high{0.0f};
};

// Points are ordered with x fastest, then y, then z; the first is at box.low, the last at box.high.
struct GridPlacement {
  glm::uvec3 size{2};
  Box3 box;
  // If true, receivers lie on a layer of points, so nothing is interpolated along this axis.
  glm::bvec3 on_layer{false};

  std::size_t count() const { return std::size_t{size.x} * size.y * size.z; }
  glm::vec3 spacing() const { return (box.high - box.low) / glm::vec3(size - 1u); }
  glm::vec3 point(std::size_t index) const {
    const glm::vec3 at(static_cast<float>(index % size.x), static_cast<float>(index / size.x % size.y),
                       static_cast<float>(index / (std::size_t{size.x} * size.y)));
    return box.low + at * spacing();
  }
};

struct PlacementWish {
  Box3 body;                      // bounds of the body
  std::optional<Box3> receivers;  // where receivers come; empty: all around
  // Number of points that the scene asks for; 0: `by_length`. With an extent they are along x, y and z.
  // Otherwise a slab takes them by length, since only here it is known which side is the short one, and other
  // boxes take as many in all, evenly spread.
  glm::uvec3 size{0};
  // Points along the longest, the middle and the shortest side. 0: 64, 64, 8 in a slab, else 32 each; with
  // few_points 32, 32, 8 and 20 each. If receivers are flat and no extent is given, slabs have the same
  // number of points in five layers, closer together.
  glm::uvec3 by_length{0};
  bool few_points = false;
  glm::vec3 extent{0.0f};  // of the box, around the body's middle; 0: by reach and receivers
  double bound = 0.01;     // relative change of irradiance below which a face may cut off the rest
};

inline constexpr std::uint32_t kMostGridPoints = 256;  // along each axis
inline constexpr float kMostReach = 12.0f;  // relative to the body's radius (half its box's diagonal)

// `changeAt` is ReceiverMeter::measure() of the change at a point. Returns nothing if no receiver comes
// within reach, or the body has no size.
std::optional<GridPlacement> placeGrid(const PlacementWish& wish,
                                       const std::function<double(const glm::vec3&)>& changeAt);

// Gives grid points the values that interpolate best, in place of the values at the points. Linear
// interpolation of a curve lies to one side of it: by δ²/12 on average over a cell, with δ² the second
// difference from point to point. After subtracting that from the points the mean is right, and the RMS error
// of a parabola falls to 0.41 of what it was along each axis. This costs no rays and no bytes.

// `values` has `width` values per point. Skips axes along which receivers lie on a layer of points
// (GridPlacement::on_layer), and points that are not `outside` or have a neighbour along the axis that is
// not, since their values are not samples of one curve.
void fitBetweenPoints(const GridPlacement& grid, std::span<const std::uint8_t> outside, std::size_t width,
                      std::span<float> values);

}  // namespace lambent::baker
