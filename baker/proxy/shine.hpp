// Finds what each triangle of a proxy sends out: the samples of the group that it stands for, and the light
// that it emits. Surface points of the group are assigned to the triangles that lie near and face alike; a
// triangle gets the means over its points.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"
#include "baker/transport/surface_colors.hpp"
#include "runtime/bundle/capture_proxy.hpp"

namespace lambent::baker {

// Divides what a proxy shows of a group into parts that are simplified separately, because emitted light must
// not spread over neighbouring surfaces and two-sided surfaces need two triangles for one.

// Spreads points evenly over triangles of a group, to take means over its surface.

struct SurfacePoint {
  std::uint32_t triangle = 0;
  float u = 0.0f, v = 0.0f;  // barycentric weights of its corners 1 and 2
  float area = 0.0f;         // square metres that the point stands for
};

float triangleArea(const GroupGeometry& geometry, std::uint32_t triangle);

// Returns `count` points of equal area, or none if there is no area. They come in equal steps along the sum
// of areas, and within a triangle by the R2 sequence (Roberts 2018), so they are the same every time.
std::vector<SurfacePoint> pointsOn(const GroupGeometry& geometry, std::span<const std::uint32_t> triangles,
                                   std::size_t count);

struct ProxyPart {
  std::uint32_t light = kNoLight;  // column of the group's light that it emits
  bool two_sided = false;
  std::vector<std::uint32_t> front, back;  // triangles of the group; back only if two-sided

  std::size_t sides() const { return two_sided ? 2 : 1; }
};

// Leaves out surfaces that are cut out or blended with a mean coverage under a half. Returns at most `most`
// parts, counted by sides; to stay within that, the smallest parts that emit light count as dark.
std::vector<ProxyPart> proxyParts(const GroupGeometry& geometry, const SurfaceColors& colors,
                                  std::size_t most);

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
