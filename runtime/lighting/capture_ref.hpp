// This is the CPU twin of the light capture's shaders, in double precision. It tests every subsample as a ray
// against every triangle, so it is slow and meant for tests. It uses the same plan for the choice of bodies
// and levels.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/lighting/capture_plan.hpp"
#include "runtime/lighting/capture_queries.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/image_layout.hpp"
#include "runtime/sh/projection.hpp"

namespace lambent::lighting::capture {

struct RefScene {
  CaptureOptions options;
  std::span<const bundle::CaptureProxy* const> proxies;
  std::span<const CaptureBody> bodies;
  std::span<const glm::vec4> triangle_radiance;
  std::span<const glm::vec3> sky_texels;  // 6 size² texels
  sh::LightVector exact_sky;
};

// Describes what a ray from the point hits: nothing, the dark side of a triangle, or its bright side.
struct RefHit {
  std::uint32_t id = 0;                                       // as in a pixel of the atlas
  double distance = std::numeric_limits<double>::infinity();  // in multiples of the direction's length
};

class RefPoint {
 public:
  RefPoint(const RefScene& scene, const CapturePoint& point) {
    std::vector<ProxyBounds> bounds;
    std::vector<std::uint32_t> first_triangle{0};
    for (const bundle::CaptureProxy* proxy : scene.proxies) {
      bounds.push_back(ProxyBounds::of(*proxy));
      first_triangle.push_back(first_triangle.back() + static_cast<std::uint32_t>(proxy->triangles.size()));
    }
    const Plan made = plan(scene.options, bounds, scene.bodies, std::span(&point, 1));
    std::vector<bool> done(scene.bodies.size());
    for (const Draw& draw : made.draws) {
      if (done[draw.body]) continue;  // it was added for another tile
      done[draw.body] = true;
      const CaptureBody& body = scene.bodies[draw.body];
      const bundle::CaptureProxy& proxy = *scene.proxies[body.proxy];
      const bundle::ProxyLevel& level = proxy.levels[draw.level];
      for (std::uint32_t t = level.first_triangle; t < level.first_triangle + level.triangle_count; ++t) {
        Triangle& triangle = triangles_.emplace_back();
        for (std::size_t k = 0; k < 3; ++k)
          triangle.corners[k] = glm::dvec3(glm::dmat4(body.world_from_proxy) *
                                           glm::dvec4(proxy.positions[proxy.triangles[t].vertices[k]], 1.0)) -
                                glm::dvec3(point.position_ws);
        triangle.front_only = proxy.triangles[t].front_only;
        triangle.id = first_triangle[body.proxy] + t + 1;
      }
    }
  }

  RefHit trace(const glm::dvec3& direction) const {
    RefHit hit;
    for (const Triangle& triangle : triangles_) {
      const auto& [a, b, c] = triangle.corners;
      // These are volumes of the tetrahedra that the direction spans with the edges. All have one sign
      // inside.
      const double u = glm::dot(direction, glm::cross(b, c)), v = glm::dot(direction, glm::cross(c, a)),
                   w = glm::dot(direction, glm::cross(a, b));
      const bool front = u <= 0 && v <= 0 && w <= 0, back = u >= 0 && v >= 0 && w >= 0;
      if (front == back || (back && triangle.front_only)) continue;
      const double distance = glm::dot(a, glm::cross(b, c)) / (u + v + w);
      if (!(distance > 0) || distance >= hit.distance) continue;
      hit = {front ? triangle.id : kBlackId, distance};
    }
    return hit;
  }

 private:
  struct Triangle {
    std::array<glm::dvec3, 3> corners{};
    bool front_only = false;
    std::uint32_t id = 0;
  };
  std::vector<Triangle> triangles_;
};

inline CapturedLight captureRef(const RefScene& scene, const CapturePoint& point) {
  const RefPoint rays(scene, point);
  const auto size = static_cast<int>(scene.options.size),
             subsamples = static_cast<int>(scene.options.subsamples);
  const double pixels = size * subsamples;
  const auto count = static_cast<std::size_t>(sh::coefficientCount(scene.options.order));
  const std::vector<float> weights = sh::cubeWeights(scene.options.order, size);
  const std::size_t texel_count = scene.sky_texels.size();
  std::vector<glm::dvec4> sums(2 * count);
  for (int face = 0; face < 6; ++face)
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        glm::dvec3 bodies(0.0);
        int covered = 0;
        for (int j = y * subsamples; j < (y + 1) * subsamples; ++j)
          for (int i = x * subsamples; i < (x + 1) * subsamples; ++i) {
            const std::uint32_t id = rays.trace(sh::cubeFaceDirection(face, 2 * (i + 0.5) / pixels - 1,
                                                                      2 * (j + 0.5) / pixels - 1))
                                         .id;
            if (id == 0) continue;
            ++covered;
            if (id != kBlackId) bodies += glm::dvec3(scene.triangle_radiance[id - 1]);
          }
        const auto texel = static_cast<std::size_t>((face * size + y) * size + x);
        const double share = static_cast<double>(covered) / (subsamples * subsamples);
        sums[0].w += 1.0 - share;
        for (std::size_t i = 0; i < count; ++i) {
          const double weight = static_cast<double>(weights[i * texel_count + texel]);
          sums[2 * i] += glm::dvec4(weight / (subsamples * subsamples) * bodies, 0.0);
          sums[2 * i + 1] += weight * share * glm::dvec4(scene.sky_texels[texel], 1.0);
        }
      }
  CapturedLight out;
  const sh::CubeProjector projector(scene.options.order, size);
  combine(std::vector<glm::vec4>(sums.begin(), sums.end()), 0, scene.exact_sky,
          projector.project(scene.sky_texels), out);
  for (const LightQuery& query : point.queries) {
    std::uint32_t bits = 0, k = 0;
    for (const glm::vec3& direction : discDirections(query)) {
      // The ray goes through the centre of the pixel that the direction falls into, as the lookup on the GPU
      // does.
      const std::uint32_t face = faceOf(direction);
      const glm::dvec3 at = faceFromWorld(face) * glm::dvec3(direction);
      const auto middle = [&](double s) {
        return 2 * (std::min(std::floor((s + 1) / 2 * pixels), pixels - 1) + 0.5) / pixels - 1;
      };
      const RefHit hit =
          rays.trace(sh::cubeFaceDirection(static_cast<int>(face), middle(at.x / at.z), middle(at.y / at.z)));
      const double w = static_cast<double>(query.distance_m) * at.z;
      if (hit.id != 0 && (w <= 0 || hit.distance < w / (1 + kSameDistance))) bits |= 1u << k;
      ++k;
    }
    out.visible.push_back(visibleShare(query, bits, out.light));
  }
  return out;
}

}  // namespace lambent::lighting::capture
