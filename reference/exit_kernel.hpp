// Computes what `--band-limit IN,OUT` puts in place of the BRDF at the first hit: its first OUT bands towards
// the eye,
//   c_k = ∫ f(v, s) max(n·s, 0) y_k(s) ds   per channel, in the world's frame.
// The surface point comes in. c goes out as spherical harmonics, which ring below the surface too, with
// directions above the surface in which to look for blockers: what blocks such a direction also blocks its
// mirror image below (docs/conventions.md, "Materials").
#pragma once

#include <array>
#include <cstdint>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

#include "reference/horizons.hpp"
#include "reference/surfaces.hpp"
#include "runtime/sh/light_vector.hpp"

namespace lambent::baker::reference {

// The diffuse part is exact. The specular one is integrated with `points` directions drawn from the BRDF, to
// about 0.1 %, with an error that depends on `seed`.
sh::LightVector exitKernel(const SurfacePoint& point, int order, std::uint32_t seed,
                           std::uint32_t points = 1024);

// Rays start above the triangle, and each stands for all directions that see what it sees (horizons.hpp).
class FirstHit {
 public:
  // `light` is all light from infinity as seen from the point.
  FirstHit(const SurfacePoint& point, int order, const sh::LightVector& light, std::uint32_t seed);

  // Radiance if nothing were in the way: Σ_k c_k l_k.
  const glm::vec3& open() const { return open_; }
  glm::vec3 kernel(const glm::vec3& dir) const { return kernel_.evaluate(dir); }
  // Sums the kernel over all directions that see what a ray above the triangle sees.
  glm::vec3 kernelOfAll(const glm::vec3& ray) const;
  // Returns what all of these directions would have sent from infinity.
  glm::vec3 skyOfAll(const glm::vec3& ray) const;

  // Returns a unit direction above the triangle, roughly in proportion to what all of its directions would
  // send from the sky, plus light as bright as the sky on average.
  glm::vec3 sample(const glm::vec2& u) const;
  float pdf(const glm::vec3& ray) const;  // 0 below the triangle

 private:
  static constexpr std::size_t kRows = 16, kColumns = 32;  // even in height and azimuth, so in solid angle
  static constexpr float kCells = kRows * kColumns;

  // Directions are in the frame of the smooth plane.
  glm::vec3 directionAt(float height, float turn) const;
  glm::vec3 mirrored(const glm::vec3& dir) const { return Horizons::mirrored(dir, horizons_.smooth); }
  glm::vec3 kernelOfPair(const glm::vec3& dir) const;
  glm::vec3 skyOfPair(const glm::vec3& dir) const;
  float pdfOfPair(const glm::vec3& dir) const;

  sh::LightVector kernel_, light_;
  glm::vec3 open_{0.0f};
  Horizons horizons_;
  glm::mat3 frame_{1.0f};                // z is the smooth normal
  std::array<float, kRows + 1> rows_{};  // cumulated, from 0 to 1
  std::array<std::array<float, kColumns + 1>, kRows> columns_{};
};

}  // namespace lambent::baker::reference
