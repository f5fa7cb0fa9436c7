// What is hidden from a point of a surface, a bit for each of many directions, and how wrong it is to show a
// mixture of other points' in its place: the transfer that interpolation over triangles gets wrong. All
// points look in the same directions, so that neighbours which see the same differ by nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/transport/ray_scene.hpp"
#include "baker/transport/seen_origins.hpp"

namespace lambent::baker {

// What one point sees, and by what share it counts in a mixture.
struct HiddenFrom {
  std::span<const std::uint16_t> masks;  // ShadowProbe::packets() of them
  glm::vec3 normal{0.0f};                // unit, of shading
  float share = 1.0f;
};

class ShadowProbe {
 public:
  // rays over the whole sphere, rounded up to whole packets of each of its quarters.
  explicit ShadowProbe(std::size_t rays);

  std::size_t rays() const { return directions_.size(); }
  std::size_t packets() const { return directions_.packets(); }

  // Fills in which directions are hidden: of a plain sample those below its faces too, of a glossy or
  // normal-mapped one what lies below its normal is mirrored, as its transfer has it. False if it is nowhere
  // where anybody could see it.
  bool look(const RayScene& scene, std::span<const SampleOrigin> origins, const glm::vec3& normal,
            SampleKind kind, std::span<std::uint16_t> masks) const;

  // What the mixture of `corners` hides more than `truth` does, by what both halves of the directions show.
  // The product of both is the mean square error, over real lights, of showing the one in place of the other,
  // relative to the light of an open point: of the irradiance, or of what glossy surfaces reflect. Free of
  // the noise of too few rays on average, for which it may come out a little below 0.
  static constexpr std::size_t kMostValues = 81;  // fewer for plain samples, the rest 0
  using Difference = std::array<std::array<float, kMostValues>, 2>;
  Difference difference(std::span<const HiddenFrom, 3> corners, const HiddenFrom& truth,
                        SampleKind kind) const;
  static double squareError(const Difference& difference);

 private:
  // Harmonics of a direction, scaled so that the square of their sum over what is wrongly hidden is an error.
  std::span<const float> row(std::size_t direction, bool plain) const;

  DirectionTable directions_;  // two halves of the table with a pattern of their own: errors are products of
                               // what one and what the other shows
  InsideTestTables inside_test_;
  std::vector<float> irradiance_, visibility_;
};

}  // namespace lambent::baker
