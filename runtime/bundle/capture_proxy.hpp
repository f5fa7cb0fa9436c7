// Payload captureProxy: a rigid group as other groups see it when they sample their incident light: a few
// triangles, each sending out one radiance in all directions,
//   Σ_i reflectance_i * (E/pi of sample i) + emission * (what light `light` of the group gives now),
// so that it is lit by whatever lights its group. Group frame, metres. Errors: lengths, indices out of range,
// values that are not finite.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"

namespace lambent::bundle {

inline constexpr std::uint32_t kMaxProxyTriangles = 256;  // of one level
inline constexpr std::uint32_t kMaxProxyLevels = 4;
inline constexpr std::uint32_t kMaxProxyEntries = 8;  // of one triangle

struct ProxyTriangle {
  std::array<std::uint32_t, 3> vertices{};  // counter-clockwise from the side that shines
  // Seen from behind: a closed or single-sided surface blocks light and is black; the side of a double-sided
  // surface is not there (its other side is a triangle of its own).
  bool front_only = false;
  glm::vec3 emission{0.0f};  // radiance at unit strength of `light`, times the share of its area that shines
  std::int32_t light = -1;   // of the group's lights; -1: gives off none
  std::uint32_t first_entry = 0, entry_count = 0;
};

// How much of a sample's E/pi the triangle sends out: albedo, times the share of the triangle that it stands
// for.
struct ProxyEntry {
  // Of the group. Where it has nine outputs, E/pi is taken at the triangle's normal.
  std::uint32_t sample = 0;
  glm::vec3 reflectance{0.0f};  // 0..1, stored in steps of 1/65535; those of a triangle sum to at most 1
};

// The finest level comes first. Each shows the whole group, with triangles of its own: first_triangle is the
// sum of the counts before it, and first_entry of a triangle likewise.
struct ProxyLevel {
  std::uint32_t first_triangle = 0, triangle_count = 0;  // 1..kMaxProxyTriangles
  float error_m = 0.0f;                                  // how far the surface may lie from the group's own
};

struct CaptureProxy {
  std::vector<glm::vec3> positions;
  std::vector<ProxyTriangle> triangles;
  std::vector<ProxyEntry> entries;
  std::vector<ProxyLevel> levels;
};

std::vector<std::byte> encodeCaptureProxy(const CaptureProxy& proxy);
// sample_count and light_count: of the group.
Result<CaptureProxy> decodeCaptureProxy(std::span<const std::byte> bytes, std::uint32_t sample_count,
                                        std::uint32_t light_count, const std::string& subject);

}  // namespace lambent::bundle
