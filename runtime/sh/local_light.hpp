// Lights that stand near, as seen from a point: what arrives there as spherical harmonics, in closed form and
// in double. Comes in: places relative to the point, metres, in any frame. Goes out: the light vector in that
// frame. Surfaces of uniform radiance are integrated over the solid angle that they fill; single directions
// give E y_i(dir), E being the irradiance on a surface that faces them. Hard cases are no errors: every
// finite input gives finite coefficients, what is not finite gives darkness; each function says what it does
// at its limits. Nothing here knows about shadows.
#pragma once

#include <glm/vec3.hpp>

#include "runtime/sh/light_vector.hpp"

namespace lambent::sh {

// A sphere of uniform radiance: a disc of angular radius asin(radius / distance), and from inside the same
// radiance from everywhere. On its surface that is a step, from half the sky to all of it. Radius 0 or less:
// dark.
LightVector sphereLight(int order, const glm::dvec3& center_from_point, double radius_m,
                        const glm::vec3& radiance_rgb);

// A flat disc of uniform radiance that shines along its normal (any length): exact wherever the point stands,
// except within 1e-4 radii of the rim, where it counts as that much in front of the plane. From the plane and
// from behind: dark. Radius 0 or less, or a normal of length 0: dark.
LightVector discAreaLight(int order, const glm::dvec3& center_from_point, const glm::dvec3& normal,
                          double radius_m, const glm::vec3& radiance_rgb);

// KHR_lights_punctual: a point without extent that gives intensity (W/sr) over squared distance, faded out
// towards range_m (0: nowhere). The extension has a pole at distance 0. Ours differs: within
// kLeastPointDistance it shines as from there, and band l shrinks with the l-th power of the distance, so
// that the light goes over to one from all around (band 0 alone at the point itself) without a jump.
inline constexpr double kLeastPointDistance = 0.01;  // metres
LightVector pointLight(int order, const glm::dvec3& light_from_point, const glm::vec3& intensity_rgb,
                       double range_m = 0.0);

// A point light within a cone about its axis (any length, the way it shines): whole within inner_cone_rad,
// dark beyond outer_cone_rad. At the light's own place the point counts as within. An axis of length 0: dark.
LightVector spotLight(int order, const glm::dvec3& light_from_point, const glm::dvec3& axis,
                      const glm::vec3& intensity_rgb, double inner_cone_rad, double outer_cone_rad,
                      double range_m = 0.0);

// One direction (any length, towards the light; 0: dark); irradiance (W/m²) on a surface that faces it.
LightVector directionalLight(int order, const glm::dvec3& to_light, const glm::vec3& irradiance_rgb);

// The factors of KHR_lights_punctual, "Range Property" and "Inner and Outer Cone Angles".
double rangeFade(double distance_m, double range_m);
double coneFade(double cos_from_axis, double inner_cone_rad, double outer_cone_rad);

}  // namespace lambent::sh
