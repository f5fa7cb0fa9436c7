// Declares the types of the light capture: its options, the bodies that are drawn, the points with their
// queries, and the resulting light.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/sh/basis.hpp"

namespace lambent::lighting {

struct CaptureOptions {
  std::uint32_t size = 16;        // texels along an edge of a cube map, 4..64
  std::uint32_t subsamples = 16;  // along an edge of a texel, 1..16
  int order = 6;                  // number of bands of the resulting light
  bool operator==(const CaptureOptions&) const = default;
};

// Describes a body at its current place. `proxy` is an index into those given to setProxies().
struct CaptureBody {
  std::uint32_t proxy = 0;
  glm::mat4 world_from_proxy{1.0f};  // rotation, translation, uniform scale
  // Bodies smaller than a quarter of a texel are left out. The limit on their size falls in proportion for a
  // body that is this many times brighter than its surroundings.
  float brightness = 1.0f;
};

// Asks which share of an analytic light is visible from a point.
struct LightQuery {
  glm::vec3 direction{0.0f, 1.0f, 0.0f};  // unit vector towards the light, world axes
  float angular_radius_rad = 0.0f;        // 0 asks for a single direction
  float distance_m = 0.0f;                // bodies beyond this distance do not hide it; 0: at infinity
};

struct CapturePoint {
  static constexpr std::uint32_t kNoBody = 0xffffffffu;
  glm::vec3 position_ws{0.0f};
  std::uint32_t own_body = kNoBody;  // index of the body that the point belongs to and does not see
  std::vector<LightQuery> queries{};
  std::vector<std::uint32_t> left_out{};  // other bodies that it does not see

  bool ignores(std::uint32_t body) const {
    return body == own_body || std::find(left_out.begin(), left_out.end(), body) != left_out.end();
  }
};

struct CapturedLight {
  sh::LightVector light;        // in world axes: the sky without its discs, and bodies
  glm::vec3 sky_visible{1.0f};  // share of the sky's light that no body hides, per channel
  std::vector<float> visible;   // for each query, 0..1
};

}  // namespace lambent::lighting
