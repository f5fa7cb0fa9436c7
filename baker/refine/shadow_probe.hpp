// Finds what is hidden from a surface point, as one bit for each of many directions, and how wrong it is to
// show a mixture of other points' bits instead: the transfer that interpolation over triangles gets wrong.
// All points use the same directions, so that neighbours which see the same have no difference.
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

// HiddenFrom holds what one point sees, and its weight in a mixture.
struct HiddenFrom {
  std::span<const std::uint16_t> masks;  // ShadowProbe::packets() values
  glm::vec3 normal{0.0f};                // unit shading normal
  float share = 1.0f;
};

class ShadowProbe {
 public:
  // `rays` go over the whole sphere; their number is rounded up to whole packets in each of its quarters.
  explicit ShadowProbe(std::size_t rays);

  std::size_t rays() const { return directions_.size(); }
  std::size_t packets() const { return directions_.packets(); }

  // Fills in which directions are hidden. For a diffuse sample, directions below its faces are hidden too;
  // for a glossy or normal-mapped one, directions below the normal are mirrored, as in its transfer. Returns
  // false if the point stands where it cannot be seen.
  bool look(const RayScene& scene, std::span<const SampleOrigin> origins, const glm::vec3& normal,
            SampleKind kind, std::span<std::uint16_t> masks) const;

  // Returns how the mixture of `corners` differs from `truth`, as seen by each half of the directions. The
  // product of both halves (squareError) is the mean square error over real lights of showing one instead of
  // the other, relative to the light of an open point: of the irradiance, or of what glossy surfaces reflect.
  // It has no bias from too few rays, and may therefore come out a little below 0.
  static constexpr std::size_t kMostValues = 81;  // diffuse samples use fewer, the rest is 0
  using Difference = std::array<std::array<float, kMostValues>, 2>;
  Difference difference(std::span<const HiddenFrom, 3> corners, const HiddenFrom& truth,
                        SampleKind kind) const;
  // Returns what arrives at a point in the same way: its square is the mean square of the light there.
  Difference arriving(const HiddenFrom& point, SampleKind kind) const;
  static double squareError(const Difference& difference);
  // Returns the irradiance by uniform light, relative to that of an open point, 0..1.
  float openShare(const HiddenFrom& point) const;

 private:
  // Returns harmonics of a direction, scaled so that the square of their sum over what is wrongly hidden is
  // an error.
  std::span<const float> row(std::size_t direction, bool plain) const;

  // Two halves with patterns of their own, because errors are products of what each half shows.
  DirectionTable directions_;
  InsideTestTables inside_test_;
  std::vector<float> irradiance_, visibility_;
};

}  // namespace lambent::baker
