// Makes the rays of one sample, sixteen at a time, in Embree's packet layout (any type with RTCRay16's
// members). This is separate from ray_scene.cpp so that the benchmark can compare Embree's bare speed with
// ours on the same rays.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "baker/transport/direction_table.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

// Distributes the rays of a sample over its origins: ray r takes the origin into whose interval of the
// cumulated weights the r-th point of the golden-ratio sequence falls, so that each origin gets its share of
// every part of the sky.
class OriginDealer {
 public:
  explicit OriginDealer(std::span<const SampleOrigin> origins) : origins_(origins) {}

  std::size_t pick(std::size_t ray) const {
    if (origins_.size() == 1) return 0;
    const std::uint32_t golden =
        static_cast<std::uint32_t>(ray) * 2654435769u;  // frac(ray * (phi - 1)) * 2^32
    float left = static_cast<float>(golden >> 8) * 0x1p-24f;
    for (std::size_t o = 0; o + 1 < origins_.size(); ++o) {
      if (left < origins_[o].weight) return o;
      left -= origins_[o].weight;
    }
    return origins_.size() - 1;
  }

 private:
  std::span<const SampleOrigin> origins_;
};

inline bool isAbove(glm::vec3 direction, const SampleOrigin& origin) {
  return glm::dot(direction, origin.geometric_normal) > 0.0f;
}

// Returns the origin that a ray starts from. If the ray lies below the horizon of the origin it was given, it
// takes the next origin that it is above, so that a convex body loses nothing of its smooth normals'
// hemispheres. If there is none, the origin it was given is returned.
inline std::size_t startOf(std::size_t ray, glm::vec3 direction, std::span<const SampleOrigin> origins,
                           const OriginDealer& dealer) {
  std::size_t origin = dealer.pick(ray);
  for (std::size_t tries = 1; tries < origins.size() && !isAbove(direction, origins[origin]); ++tries)
    origin = origin + 1 == origins.size() ? 0 : origin + 1;
  return origin;
}

// This says what a direction below the horizon of its origin sees. Blocked: it starts from another origin
// that it is above, and is blocked if there is none. Mirrored: it is reflected about the origin's plane
// (docs/conventions.md, "Exit kernel"), as everywhere on the face that the origin stands for.
enum class BelowHorizon { Blocked, Mirrored };

inline glm::vec3 mirroredAbove(glm::vec3 direction, const SampleOrigin& origin) {
  const float below = glm::dot(direction, origin.geometric_normal);
  return below > 0.0f ? direction : direction - 2.0f * below * origin.geometric_normal;
}

// Says which rays of a packet are traced (-1, else 0) and which origin each starts from.
struct PacketLanes {
  alignas(64) std::array<int, kPacketWidth> valid;
  std::array<std::size_t, kPacketWidth> origin;
};

// SampleRays are the rays of one sample: the directions of a table, rotated by the sample's frame.
struct SampleRays {
  std::span<const SampleOrigin> origins;  // not empty
  glm::mat3 frame{1.0f};                  // group_from_local
  const DirectionTable& table;
  BelowHorizon below = BelowHorizon::Blocked;
};

// Fills packet p of the table. Lanes below the horizons of all origins are not valid, or mirrored.
template <typename Ray16>
void fillPacket(std::size_t p, const SampleRays& rays, const OriginDealer& dealer, Ray16& ray,
                PacketLanes& lanes) {
  const auto& [origins, frame, table, below] = rays;
  const std::size_t first = p * kPacketWidth;
  for (std::size_t k = 0; k < kPacketWidth; ++k) {
    const float x = table.x[first + k], y = table.y[first + k], z = table.z[first + k];
    ray.dir_x[k] = frame[0].x * x + frame[1].x * y + frame[2].x * z;
    ray.dir_y[k] = frame[0].y * x + frame[1].y * y + frame[2].y * z;
    ray.dir_z[k] = frame[0].z * x + frame[1].z * y + frame[2].z * z;
    ray.tnear[k] = 0.0f;
    ray.tfar[k] = std::numeric_limits<float>::infinity();
    ray.time[k] = 0.0f;
    ray.mask[k] = ~0u;
    ray.flags[k] = 0;
  }
  for (std::size_t k = 0; k < kPacketWidth; ++k) {
    const glm::vec3 direction(ray.dir_x[k], ray.dir_y[k], ray.dir_z[k]);
    const std::size_t origin = below == BelowHorizon::Mirrored
                                   ? dealer.pick(first + k)
                                   : startOf(first + k, direction, origins, dealer);
    const SampleOrigin& start = origins[origin];
    ray.org_x[k] = start.position.x;
    ray.org_y[k] = start.position.y;
    ray.org_z[k] = start.position.z;
    lanes.origin[k] = origin;
    lanes.valid[k] = isAbove(direction, start) ? -1 : 0;
    if (lanes.valid[k] || below == BelowHorizon::Blocked) continue;
    const glm::vec3 image = mirroredAbove(direction, start);
    ray.dir_x[k] = image.x;
    ray.dir_y[k] = image.y;
    ray.dir_z[k] = image.z;
    lanes.valid[k] = isAbove(image, start) ? -1 : 0;  // rays along the plane itself stay invalid
  }
}

}  // namespace lambent::baker
