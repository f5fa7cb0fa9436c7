// The room baker/proxy makes the capture proxy: a rigid group in a few triangles, as other groups see it when
// they sample their light. Geometry, samples and colours of the group, as they ship, and their importance
// come in; the payload's content in the group's frame goes out, with levels of at most 256, 64 and 16
// triangles. It works on several threads and has no errors.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "baker/importance/importance.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"
#include "baker/transport/surface_colors.hpp"
#include "runtime/bundle/capture_proxy.hpp"

namespace lambent::baker {

// Simplifies a surface to fewer triangles, by meshoptimizer.

struct SimpleMesh {
  std::vector<glm::vec3> positions;  // as GroupGeometry::positions; each is used
  std::vector<glm::uvec3> triangles;
  float error_m = 0.0f;  // how far it may lie from the surface that it was made of
};

// Returns the triangles as they are, with vertices at the same place (but for rounding) welded.
SimpleMesh welded(const GroupGeometry& geometry, std::span<const std::uint32_t> triangles);

// Returns at most `most` triangles (4 or more), and at least one if any has an area. It collapses edges
// (Garland and Heckbert 1997); if the topology does not allow that, it clusters vertices; and if that loses
// the surface, it returns its bounding box or a tetrahedron. Where fewer triangles stay within allowed_m of
// the mesh, it returns these.
SimpleMesh simplified(const SimpleMesh& mesh, std::size_t most, float allowed_m = 0.0f);

// Measures how large a surface looks from far away.

class Silhouette {
 public:
  explicit Silhouette(std::span<const SimpleMesh> original);

  // Returns by how much `proxy` must grow, as a length, to cover as much as the original does, seen from far
  // away along seven axes (mean of areas). Of the proxy, only what lies within the original's bounds counts.
  // Returns 1 if either covers nothing; the result is within 1/2..2.
  float scaleOf(std::span<const SimpleMesh> proxy) const;

 private:
  struct View {
    glm::vec3 right{0.0f}, up{0.0f};
    glm::vec2 low{0.0f}, high{0.0f};  // bounds of the original
    double pixel = 0.0;               // square metres; 0 if seen edge on
    double covered = 0.0;             // pixels
  };
  static double pixelsOf(std::span<const SimpleMesh> meshes, const View& view);

  std::array<View, 7> views_;
};

// Finds what each triangle of a proxy sends out: the samples of the group that it stands for, and the light
// that it emits. Surface points of the group are assigned to the triangles that lie near and face alike; a
// triangle gets the means over its points.

// Divides what a proxy shows of a group into parts that are simplified separately, because emitted light must
// not spread over neighbouring surfaces and two-sided surfaces need two triangles for one.

// Spreads points evenly over triangles of a group, to take means over its surface.

struct SurfacePoint {
  std::uint32_t triangle = 0;
  float u = 0.0f, v = 0.0f;  // barycentric weights of its corners 1 and 2
  float area = 0.0f;         // square metres that the point stands for
};

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

// Returns no level if the group shows nothing: it has no area, or only surfaces that are mostly transparent.
bundle::CaptureProxy makeCaptureProxy(const GroupGeometry& geometry, const SampleSet& samples,
                                      const SurfaceColors& colors, const Importance& importance);

}  // namespace lambent::baker
