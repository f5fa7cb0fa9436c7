#include "runtime/streaming/interest.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>

namespace lambent::streaming {

namespace {

// Values of steps, relative to the last share of planes of something seen with the same size. So surfaces are
// kept until something else appears sqrt(64) times larger.
constexpr float kSurfaces = 64.0f, kCodebooks = 16.0f, kFirstPlanes = 8.0f, kLastPlanes = 1.0f;
// Value of a texture level whose texels are at least as large as pixels. The value falls with the area of
// smaller texels.
constexpr float kTexels = 8.0f;
// Diameter, in pixels, of a sphere of size 1 in a picture with 1080 rows and a field of view of 50 degrees.
constexpr float kPixels = 2300.0f;
// Factor on the value of steps that were chosen before.
constexpr float kStays = 1.5f;
static_assert(kSurfaces > kStays * kCodebooks && kCodebooks > kStays * kFirstPlanes);

constexpr std::uint64_t kProxyLodShare = 4;  // proxy levels of detail may take 1/4 of the memory first

constexpr float kOutOfSight = 0.1f;  // factor for spheres out of sight, as the camera may turn at any moment
constexpr float kLargest = 100.0f;   // limit of the size, for a camera inside or almost inside the sphere

struct Candidate {
  float worth = 0.0f;
  std::uint32_t bundle = 0, unit = 0, step = 0;
  std::uint64_t bytes = 0;
};

}  // namespace

float worthOf(const Parts& parts, std::uint32_t unit, std::uint32_t step, float size) {
  if (unit == 0) return size * kSurfaces;
  if (parts.isImage(unit)) {
    const Parts::Image& image = parts.imageOf(unit);
    const std::uint32_t side = std::max(image.width, image.height) >> (image.coarse - 1 - step);
    const float pixels_a_texel = kPixels * std::sqrt(size) / static_cast<float>(side);
    return size * kTexels * std::min(pixels_a_texel * pixels_a_texel, 1.0f);
  }
  if (step == 0) return size * kCodebooks;
  const std::size_t steps = parts.units[unit].size();
  const float share = static_cast<float>(step - 1) / static_cast<float>(std::max<std::size_t>(steps - 1, 1));
  return size * (kFirstPlanes + share * (kLastPlanes - kFirstPlanes));
}

float sizeSeen(const spec::View& view, const glm::vec3& center_ws, float radius_m) {
  const float distance = std::max(0.0f, glm::distance(view.eye_ws, center_ws) - radius_m);  // 0 for NaN
  const float size = distance > 0.0f ? radius_m / distance : std::numeric_limits<float>::infinity();
  float seen = std::min(size * size, kLargest);
  const glm::mat4 clip_from_world = view.clip_from_view * view.view_from_world;
  const glm::vec4 w = glm::row(clip_from_world, 3);
  for (int axis = 0; axis < 2; ++axis)
    for (const float sign : {1.0f, -1.0f}) {
      const glm::vec4 plane = w + sign * glm::row(clip_from_world, axis);
      const float normal = glm::length(glm::vec3(plane));
      if (normal > 0.0f && glm::dot(plane, glm::vec4(center_ws, 1.0f)) < -radius_m * normal)
        return kOutOfSight * seen;
    }
  return seen;
}

void choose(std::span<Interest> bundles, std::uint64_t max_bytes) {
  std::vector<Candidate> candidates;
  for (std::uint32_t b = 0; b < bundles.size(); ++b) {
    Interest& bundle = bundles[b];
    for (std::uint32_t u = 0; u < bundle.parts->units.size(); ++u) {
      const Unit& unit = bundle.parts->units[u];
      for (std::uint32_t s = 0; s < unit.size(); ++s) {
        const float stays = s < bundle.target[u] ? kStays : 1.0f;
        candidates.push_back({stays * worthOf(*bundle.parts, u, s, bundle.size[u]), b, u, s, unit[s].bytes});
      }
    }
    std::ranges::fill(bundle.target, 0u);
  }
  std::ranges::sort(candidates, [](const Candidate& a, const Candidate& b) {
    return std::tuple(-a.worth, a.bundle, a.unit, a.step) < std::tuple(-b.worth, b.bundle, b.unit, b.step);
  });
  std::uint64_t taken = 0;
  const auto take = [&](const Candidate& candidate, std::uint64_t most) {
    Interest& bundle = bundles[candidate.bundle];
    // If a step did not fit, later steps of the unit cannot be taken.
    if (bundle.target[candidate.unit] != candidate.step) return;
    if (candidate.unit != 0 && bundle.target[0] != bundle.parts->surfaceSteps()) return;
    if (taken + candidate.bytes > most) return;
    taken += candidate.bytes;
    ++bundle.target[candidate.unit];
  };
  const auto isProxyLod = [&](const Candidate& candidate) {
    return candidate.unit == 0 && candidate.step + 1 < bundles[candidate.bundle].parts->surfaceSteps();
  };
  const auto largest = std::ranges::find_if(
      candidates, [&](const Candidate& candidate) { return candidate.unit == 0 && !isProxyLod(candidate); });
  if (largest == candidates.end()) return;
  constexpr std::uint64_t kInAnyCase = ~std::uint64_t{0};
  for (const Candidate& candidate : candidates)
    if (candidate.bundle == largest->bundle && candidate.unit == 0) take(candidate, kInAnyCase);
  const std::uint64_t with_proxy_lods = std::min(max_bytes, taken + max_bytes / kProxyLodShare);
  for (const Candidate& candidate : candidates)
    if (isProxyLod(candidate)) take(candidate, with_proxy_lods);
  for (const Candidate& candidate : candidates) take(candidate, max_bytes);
}

}  // namespace lambent::streaming
