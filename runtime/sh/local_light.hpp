// Computes the light vector that a local light sends to a point, in closed form and in double precision.
// Positions are relative to the point, in metres, in any frame; the light vector is in the same frame.
// Surfaces of uniform radiance are integrated over the solid angle that they fill. A light from a single
// direction gives E y_i(dir), where E is the irradiance on a surface that faces it. There are no errors:
// finite input gives finite coefficients, and other input gives darkness. Shadows are ignored.
#pragma once

#include <glm/vec3.hpp>

#include "runtime/sh/basis.hpp"

namespace lambent::sh {

// Integrates a sphere of uniform radiance. From outside it is a disc of angular radius asin(radius /
// distance); from inside the same radiance arrives from everywhere, so at its surface light jumps from half
// the sphere of directions to all of it. A radius of 0 or less gives darkness.
LightVector sphereLight(int order, const glm::dvec3& center_from_point, double radius_m,
                        const glm::vec3& radiance_rgb);

// Integrates a flat disc of uniform radiance that shines towards its normal (any length). The result is exact
// except within 1e-4 radii of the rim, where the point is treated as that far in front of the plane. Points
// in the plane or behind it are dark. A radius of 0 or less or a normal of length 0 gives darkness.
LightVector discAreaLight(int order, const glm::dvec3& center_from_point, const glm::dvec3& normal,
                          double radius_m, const glm::vec3& radiance_rgb);

// A point light of KHR_lights_punctual gives intensity (W/sr) over squared distance, and fades out towards
// range_m (0 for no limit). The extension has a pole at distance 0. Ours differs: nearer than
// kLeastPointDistance the intensity stays as at that distance, and band l shrinks with the l-th power of the
// distance. So the light changes continuously to one from all around, with only band 0 at the point itself.
inline constexpr double kLeastPointDistance = 0.01;  // metres
LightVector pointLight(int order, const glm::dvec3& light_from_point, const glm::vec3& intensity_rgb,
                       double range_m = 0.0);

// Describes the cone of a spot light, about an axis of any length that points the way it shines. Light is
// whole within the inner angle and dark beyond the outer one. A point at the light's own place counts as
// within. An axis of length 0 gives darkness.
struct SpotCone {
  glm::dvec3 axis;
  double inner_rad, outer_rad;
};
LightVector spotLight(int order, const glm::dvec3& light_from_point, const SpotCone& cone,
                      const glm::vec3& intensity_rgb, double range_m = 0.0);

// Returns light from one direction, given by a vector of any length towards the light; length 0 gives
// darkness. The irradiance (W/m²) is that on a surface that faces the light.
LightVector directionalLight(int order, const glm::dvec3& to_light, const glm::vec3& irradiance_rgb);

// Return the factors of KHR_lights_punctual, sections "Range Property" and "Inner and Outer Cone Angles".
double rangeFade(double distance_m, double range_m);
double coneFade(double cos_from_axis, double inner_cone_rad, double outer_cone_rad);

}  // namespace lambent::sh
