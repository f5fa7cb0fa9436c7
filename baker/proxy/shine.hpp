// Finds what each triangle of a proxy sends out: the samples of the group that it stands for, and the light
// that it emits. Surface points of the group are assigned to the triangles that lie near and face alike; a
// triangle gets the means over its points.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/proxy/parts.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/bundle/capture_proxy.hpp"

namespace lambent::baker {

// A ProxyFace is one side of a simplified surface, in the group's frame.
struct ProxyFace {
  std::array<glm::vec3, 3> corners;
  std::uint32_t part = 0;
  bool back = false;
};

struct FaceShine {
  std::vector<bundle::ProxyEntry> entries;  // at most bundle::kMaxProxyEntries
  glm::vec3 emission{0.0f};
};

// A ShiningPoint is a surface point with what it reflects, and emits at unit strength.
struct ShiningPoint {
  SurfacePoint at;
  glm::vec3 position, normal;  // the normal is that of the face, unit
  glm::vec3 reflectance, emission;
};

std::vector<ShiningPoint> shiningPoints(const GroupGeometry& geometry, const SurfaceColors& colors,
                                        std::span<const std::uint32_t> triangles, bool gives_light,
                                        std::size_t count);

// Returns one entry per face. `points` is indexed by part and side. Emissions of a part add up to as much
// power (area x radiance) as its points have.
std::vector<FaceShine> shineOf(std::span<const ProxyFace> faces,
                               std::span<const std::array<std::vector<ShiningPoint>, 2>> points,
                               const GroupGeometry& geometry, const SampleSet& samples);

}  // namespace lambent::baker
