// The payload captureProxy shows a rigid group to other groups when they sample their incident light. It is a
// mesh of a few triangles, each of which sends out the same radiance in all directions:
//   Σ_i reflectance_i * (E/pi of sample i) + emission * (current strength and colour of light `light`).
// The proxy is therefore lit by whatever lights its group. Positions are in the group's frame, in metres.
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

inline constexpr std::uint32_t kMaxProxyTriangles = 256;  // per level
inline constexpr std::uint32_t kMaxProxyLevels = 4;
inline constexpr std::uint32_t kMaxProxyEntries = 8;  // per triangle
inline constexpr std::uint32_t kMaxPatchTriangles = 2048;

struct ProxyTriangle {
  std::array<std::uint32_t, 3> vertices{};  // counter-clockwise seen from the side that sends out light
  // If true, the triangle is invisible from behind: it is one side of a double-sided surface, and the other
  // side has a triangle of its own. If false, it blocks light and is black from behind.
  bool front_only = false;
  glm::vec3 emission{0.0f};  // radiance at unit strength of `light`, times the share of its area that emits
  std::int32_t light = -1;   // index into the group's lights; -1 if the triangle emits nothing
  std::uint32_t first_entry = 0, entry_count = 0;
};

// Names a sample whose E/pi the triangle reflects. The reflectance is the albedo times the share of the
// triangle's area that the sample represents.
struct ProxyEntry {
  // Sample of the group. If it has nine outputs, E/pi is taken at the triangle's normal.
  std::uint32_t sample = 0;
  glm::vec3 reflectance{0.0f};  // 0..1, stored in steps of 1/65535; those of a triangle sum to at most 1
};

// Describes a level of detail. The finest comes first, and each shows the whole group with triangles of its
// own. first_triangle is the sum of the counts of the levels before it; first_entry of a triangle likewise.
struct ProxyLevel {
  std::uint32_t first_triangle = 0, triangle_count = 0;  // 1..kMaxProxyTriangles
  float error_m = 0.0f;                                  // largest distance from the group's own surface
};

struct PatchTriangle {
  std::array<std::uint32_t, 3> vertices{};  // as of a ProxyTriangle, and so is the next
  bool front_only = false;
  glm::vec3 albedo{0.0f};  // 0..1, stored in steps of 1/255
  // How many patches the triangle deserves for its area, relative to others (patchDensity), 0..127. Files
  // from before 0.11 have 0 everywhere.
  std::uint8_t detail = 0;
};
// Patches per area are 2^(detail / 8), relative to other triangles of the surface.
float patchDensity(std::uint8_t detail);
inline constexpr float kLeastPatchDensity = 0x1p-15f;  // relative to the most
// Returns the detail for a density from kLeastPatchDensity to 1.
std::uint8_t detailOf(float density);

// Shows the group to its own parts, which are nearer to each other than other groups are: light that goes to
// and fro between them needs their floor, their columns and their arches. Without triangles, the finest level
// serves.
struct PatchSurface {
  std::vector<glm::vec3> positions;
  std::vector<PatchTriangle> triangles;  // at most kMaxPatchTriangles
  float error_m = 0.0f;                  // as of a ProxyLevel
};

struct CaptureProxy {
  std::vector<glm::vec3> positions;
  std::vector<ProxyTriangle> triangles;
  std::vector<ProxyEntry> entries;
  std::vector<ProxyLevel> levels;
  PatchSurface patches;
};

// Returns the group as its own parts see it: `patches`, or the finest level with the reflectance of its
// entries.
PatchSurface patchSurfaceOf(const CaptureProxy& proxy);

std::vector<std::byte> encodeCaptureProxy(const CaptureProxy& proxy);
// `sample_count` and `light_count` are those of the group. Fails, naming `subject`, if sizes do not add up,
// indices are out of range, values are not finite, or a triangle reflects more than it receives.
Result<CaptureProxy> decodeCaptureProxy(std::span<const std::byte> bytes, std::uint32_t sample_count,
                                        std::uint32_t light_count, const std::string& subject);

}  // namespace lambent::bundle
