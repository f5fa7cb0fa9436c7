// Light in real spherical harmonics: L(s) = sum_i c_i y_i(s) is the radiance, linear Rec.709 RGB, that
// arrives from the unit direction s. Functions are orthonormal and without the Condon-Shortley sign;
// coefficient l (l + 1) + m belongs to y_lm; order n means n bands and n² coefficients (docs/conventions.md).
// All of this is computed on the CPU, without OpenGL, and may be called from any thread.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "lambent/export.hpp"
#include "lambent/math.hpp"
#include "lambent/result.hpp"

namespace lambent {

inline constexpr int kMaxBands = 8;

// Writes y_i(direction) for all order² functions to `out`, which has room for them. Fails if the order is not
// 1..8 or `out` is too short.
LAMBENT_API Expected<void> evaluateHarmonics(int order, const Vec3& direction, std::span<float> out);

struct LightVector {
  int order = 5;                     // 1..kMaxBands
  std::vector<Vec3> coefficients{};  // order² of them; fewer count as zeros

  // Returns L(direction). It may be negative where few bands ring.
  LAMBENT_API Vec3 radiance(const Vec3& direction) const;
  // Returns the irradiance on an unoccluded surface with this unit normal, divided by pi, so that light of
  // radiance 1 from everywhere gives 1 (Ramamoorthi and Hanrahan 2001).
  LAMBENT_API Vec3 irradianceOverPi(const Vec3& normal) const;
  // Returns the light with the least change of its bands that leaves no direction negative.
  LAMBENT_API LightVector withoutRinging() const;
  // Returns the light as it is seen from a frame that is turned: `local_from_world` has unit columns that
  // stand at right angles, row by row {x x, x y, x z, y x, ...}. Fails if it is no rotation.
  LAMBENT_API Expected<LightVector> rotated(const std::array<float, 9>& local_from_world) const;
};

// Projects a picture of the whole sphere, twice as wide as high, row by row from the top. The top row is +Y,
// the centre looks along +X, and right of it lies +Z. Texels are mean radiances; those that are not finite
// count as black. Fails if the shape or the order is wrong.
LAMBENT_API Expected<LightVector> projectEquirect(std::span<const Vec3> texels, int width, int height,
                                                  int order);

// Returns the light of words as --light of lambent's programs takes them, added up: environment maps (.hdr,
// .exr), constant:R,G,B and sun:AZ,EL,ANGLE,R,G,B, whose angles are degrees (docs/conventions.md). Fails if a
// word is wrong, a file cannot be read, or a light is not at infinity.
LAMBENT_API Expected<LightVector> lightFrom(const std::vector<std::string>& words, int order);

}  // namespace lambent
