// Computes the response that `--band-limit IN,OUT` uses instead of the BRDF at the first hit: its first OUT
// bands towards the eye,
//   c_k = ∫ f(v, s) max(n·s, 0) y_k(s) ds   per channel, in world space.
// The surface point comes in. c goes out as spherical harmonics, which are not zero below the surface, and
// directions above the surface in which to test visibility: an occluder in such a direction also blocks the
// mirrored direction below (docs/conventions.md, "Materials").
#pragma once

#include <array>
#include <cstdint>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

#include "reference/brdf.hpp"
#include "reference/surfaces.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::baker::reference {

// Returns c. The diffuse part is exact. The specular part is integrated with `points` directions sampled from
// the BRDF, with an error of about 0.1 % that depends on `seed`.
sh::LightVector exitKernel(const SurfacePoint& point, int order, std::uint32_t seed,
                           std::uint32_t points = 1024);

// Combines the exit kernel with the light at one surface point. Rays start above the triangle, and each
// stands for all directions that are mirrored to it (Horizons).
class FirstHit {
 public:
  // `light` is all distant light as seen from the point.
  FirstHit(const SurfacePoint& point, int order, const sh::LightVector& light, std::uint32_t seed);

  // Returns the radiance without occlusion, Σ_k c_k l_k.
  const glm::vec3& open() const { return open_; }
  glm::vec3 kernel(const glm::vec3& dir) const { return kernel_.evaluate(dir); }
  // Returns the sum of the kernel over all directions that a ray above the triangle stands for.
  glm::vec3 kernelOfAll(const glm::vec3& ray) const;
  // Returns the sum of kernel times distant light over all these directions.
  glm::vec3 skyOfAll(const glm::vec3& ray) const;

  // Returns a unit direction above the triangle. The density is roughly proportional to skyOfAll() plus an
  // estimate of the light that occluders send instead.
  glm::vec3 sample(const glm::vec2& u) const;
  float pdf(const glm::vec3& ray) const;  // per steradian; 0 below the triangle

 private:
  // The cells have equal solid angles, because they are uniform in height and azimuth.
  static constexpr std::size_t kRows = 16, kColumns = 32;
  static constexpr float kCells = kRows * kColumns;

  // These use directions in the frame of the smooth normal.
  glm::vec3 directionAt(float height, float turn) const;
  glm::vec3 mirrored(const glm::vec3& dir) const { return Horizons::mirrored(dir, horizons_.smooth); }
  glm::vec3 kernelOfPair(const glm::vec3& dir) const;
  glm::vec3 skyOfPair(const glm::vec3& dir) const;
  float pdfOfPair(const glm::vec3& dir) const;

  sh::LightVector kernel_, light_;
  glm::vec3 open_{0.0f};
  Horizons horizons_;
  glm::mat3 frame_{1.0f};                // z is the smooth normal
  std::array<float, kRows + 1> rows_{};  // cumulative distribution, from 0 to 1
  std::array<std::array<float, kColumns + 1>, kRows> columns_{};
};

}  // namespace lambent::baker::reference
