// What is hidden from a point of a surface, in a few numbers that can be compared with those of its
// neighbours: the transfer that interpolation over triangles gets wrong. All points look in the same
// directions, so that neighbours which see the same differ by nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/transport/ray_scene.hpp"

namespace lambent::baker {

inline constexpr int kShadowOrder = 5;
// Of what is hidden, coefficients in spherical harmonics scaled so that the squared difference of two points
// is the mean squared error, over real lights, of showing one in place of the other, relative to the light of
// an open point.
using Shadow = std::array<float, kShadowOrder * kShadowOrder>;

class ShadowProbe {
 public:
  // rays over the whole sphere, rounded up to whole packets of each half.
  explicit ShadowProbe(std::size_t rays);

  // Of a plain sample the irradiance that is hidden from its normal; of others the visibility itself,
  // mirrored below the faces. Points without an origin are taken as open.
  Shadow at(const RayScene& scene, std::span<const SampleOrigin> origins, const glm::vec3& normal,
            SampleKind kind) const;
  std::size_t rays() const { return directions_.size(); }

 private:
  DirectionTable directions_;
  std::vector<Shadow> irradiance_, visibility_;  // what each direction adds, before the cosine
};

inline float squaredDifference(const Shadow& a, const Shadow& b) {
  float sum = 0.0f;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

}  // namespace lambent::baker
