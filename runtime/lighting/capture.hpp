// Incident light sampled on the fly (Sloan, Kautz and Snyder 2002, section 6): around each point the sky and
// the bodies of other rigid groups are drawn into a small cube map in world axes, and that is projected to
// spherical harmonics on the GPU. Comes in: the environment, bodies as capture proxies with a radiance per
// triangle, points. Goes out, some frames later: per point the light that arrives there and how much of each
// analytic light is not hidden. Analytic lights never pass through the texels. Errors: shaders that do not
// compile on this device.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/sh/light_vector.hpp"

namespace lambent::lighting {

struct CaptureOptions {
  std::uint32_t size = 16;        // texels along an edge of a cube map, 4..64
  std::uint32_t subsamples = 16;  // along an edge of a texel, 1..16
  int order = 6;                  // bands of the light that comes out
  bool operator==(const CaptureOptions&) const = default;
};

// A body where it stands now. Its proxy is one of those given to setProxies.
struct CaptureBody {
  std::uint32_t proxy = 0;
  glm::mat4 world_from_proxy{1.0f};
  // Bodies under a quarter of a texel are left out; one that shines this many times brighter than its
  // surroundings, only when it is as many times smaller.
  float brightness = 1.0f;
};

// A light that goes to harmonics in closed form, as seen from a point: what of it is not hidden?
struct LightQuery {
  glm::vec3 direction{0.0f, 1.0f, 0.0f};  // unit, world, towards it
  float angular_radius_rad = 0.0f;        // 0: a single direction
  float distance_m = 0.0f;                // bodies farther away do not hide it; 0: at infinity
  glm::vec3 radiance{0.0f};  // of a disc that is partly hidden, for its shape; 0 for single directions
};

struct CapturePoint {
  static constexpr std::uint32_t kNoBody = 0xffffffffu;
  glm::vec3 position_ws{0.0f};
  std::uint32_t own_body = kNoBody;  // index into the bodies; does not see itself
  std::vector<LightQuery> queries;
};

struct CapturedLight {
  // World axes. Sky (without its discs) and bodies; where a disc of a query is partly hidden, also what is
  // then wrong with `visible` times the whole disc.
  sh::LightVector light;
  glm::vec3 sky_visible{1.0f};  // share of the sky's light that no body hides
  std::vector<float> visible;   // per query, 0..1
};

class Capture {
 public:
  static Result<Capture> create(const CaptureOptions& options, const Environment& environment);

  // All proxies anew; triangles are numbered through them in their order.
  void setProxies(std::span<const bundle::CaptureProxy* const> proxies, gpu::Counters& counters);
  std::uint32_t firstTriangle(std::size_t proxy) const;
  std::uint32_t triangleCount() const;

  // Whether a body at this place would be drawn at all for this point.
  bool sees(const CapturePoint& point, const CaptureBody& body) const;

  // Draws and projects; one draw and one dispatch per page of cube maps. triangle_radiance: vec4 per
  // triangle. Not to be called while pending().
  Result<void> run(const Environment& environment, std::span<const CaptureBody> bodies,
                   std::span<const CapturePoint> points, const gpu::Buffer& triangle_radiance,
                   gpu::Counters& counters);
  bool pending() const;
  // The light of the last run, one per point; none while the GPU is still at it, unless told to wait.
  std::optional<std::vector<CapturedLight>> take(bool wait);

 private:
  Capture() = default;
};

}  // namespace lambent::lighting
