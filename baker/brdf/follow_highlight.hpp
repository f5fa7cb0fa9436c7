// Samples one step of a path through a GGX highlight. It samples visible normals (Heitz 2018; caps after
// Dupuy and Benyoub 2023), whose weight is F G2/G1; that of a mirror is its reflectance.
#pragma once

#include <cstdint>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "baker/brdf/surface_brdfs.hpp"

namespace lambent::baker {

struct HighlightSample {
  glm::vec3 direction{0.0f};  // unit, group frame, above the plane of the normal: where light comes from
  // Light from `direction` is what a ray along `ray` meets: it is the same direction, or its mirror image if
  // the triangle hides it (docs/conventions.md, "Materials").
  glm::vec3 ray{0.0f};
  glm::vec3 weight{0.0f};  // f cos / pdf
};

// `to` is unit and points to where the light is wanted; `u` is in the unit square. The weight is 0 if there
// is no sample.
HighlightSample sampleHighlight(const PointReflection& at, const glm::vec3& to, const glm::vec2& u);

// Returns points that are evenly spread over the unit square for successive numbers: R2, the generalised
// golden ratio (Roberts 2018), shifted for each `step` of a path.
glm::vec2 choices(std::uint32_t number, std::uint32_t step);

}  // namespace lambent::baker
