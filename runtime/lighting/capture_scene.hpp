// What the light capture draws and looks from: options, bodies, points with their queries, and the light that
// comes out. Types only.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

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
  glm::mat4 world_from_proxy{1.0f};  // rotation, translation, uniform scale
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
  std::vector<LightQuery> queries{};
  std::vector<std::uint32_t> left_out{};  // bodies that it does not see either

  bool ignores(std::uint32_t body) const {
    return body == own_body || std::find(left_out.begin(), left_out.end(), body) != left_out.end();
  }
};

struct CapturedLight {
  // World axes. Sky (without its discs) and bodies; where a disc of a query is partly hidden, also what is
  // then wrong with `visible` times the whole disc.
  sh::LightVector light;
  glm::vec3 sky_visible{1.0f};  // share of the sky's light that no body hides
  std::vector<float> visible;   // per query, 0..1
};

}  // namespace lambent::lighting
