// One step of a path through a GGX highlight: visible normals (Heitz 2018; caps after Dupuy and Benyoub
// 2023), whose weight is F G2/G1, and so a mirror's is its reflectance.
#pragma once

#include <cstdint>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "baker/brdf/surface_brdfs.hpp"

namespace lambent::baker {

struct HighlightSample {
  glm::vec3 direction{0.0f};  // unit, group frame, above the plane of the normal: where light comes from
  // What stands there is what this one meets: the same, or its mirror image where the triangle hides it
  // (docs/conventions.md, "Materials").
  glm::vec3 ray{0.0f};
  glm::vec3 weight{0.0f};  // f cos / pdf
};

// to: unit, towards where the light is wanted; u from the unit square.
HighlightSample sampleHighlight(const PointReflection& at, const glm::vec3& to, const glm::vec2& u);

// Evenly spread over the unit square for the numbers in a row: R2, the generalised golden ratio (Roberts
// 2018), shifted for each `step` of a path.
glm::vec2 choices(std::uint32_t number, std::uint32_t step);

}  // namespace lambent::baker
