// A DirectionTable holds the directions of every sample's rays over the local hemisphere (z up). They are
// low-discrepancy and sorted along a Hilbert curve, so that sixteen neighbours make a coherent ray packet.
// All samples share one table, so its spherical harmonics are evaluated once.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace lambent::baker {

inline constexpr std::size_t kPacketWidth = 16;

struct DirectionTable {
  // These are unit vectors, with one array per axis; the size is a multiple of kPacketWidth.
  std::vector<float> x, y, z;

  std::size_t size() const { return x.size(); }
  std::size_t packets() const { return x.size() / kPacketWidth; }
};

// Makes directions with pdf = cos/pi: a Fibonacci lattice on the unit square goes through the concentric map
// to the disc (Shirley and Chiu 1997) and is lifted to the hemisphere (Malley). `rays` is rounded up to whole
// packets.
DirectionTable cosineTable(std::size_t rays);

// Spreads the same points evenly over the hemisphere: pdf = 1/(2 pi). This serves light that is evaluated at
// any normal, for which light near the horizon counts.
DirectionTable uniformTable(std::size_t rays);

// Builds the local frame of a sample, with z along its normal, without a singularity at the poles (Duff et
// al., JCGT 6(1), 2017).

// Returns group_from_local, whose columns are tangent, bitangent and normal. `n` is a unit vector.
inline glm::dmat3 localFrame(const glm::dvec3& n) {
  const double sign = std::copysign(1.0, n.z);
  const double a = -1.0 / (sign + n.z);
  const double b = n.x * n.y * a;
  return {glm::dvec3(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
          glm::dvec3(b, sign + n.y * n.y * a, -n.y), n};
}

}  // namespace lambent::baker
