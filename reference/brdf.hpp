// How a place reflects, towards one view (docs/conventions.md, "Materials"): GGX with Fresnel over a diffuse
// part, round or anisotropic, or a BRDF of its own (whole_brdf.hpp). Values, densities and directions are
// local: z the shading normal, x the tangent; v and s point away from the surface. Shares nothing with
// baker/brdf but the loader of measured files: the reference is to find its mistakes.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace lambent::baker::reference {

class WholeBrdf;

inline constexpr float kLeastAlpha = 0.001f;
// Views below this cosine are lifted to it.
inline constexpr float kLeastCosine = 0.001f;

// Returns alpha along the tangent and across it.
glm::vec2 ggxAlpha(float roughness, float strength);

// Returns f times the cosine of s, without Fresnel's factors: F0 multiplies x, F90 multiplies y. Returns 0 if
// s.z <= 0.
glm::vec2 ggxValue(const glm::vec2& alpha, const glm::vec3& v, const glm::vec3& s);
// These sample the normals that v sees (Heitz 2018). Some directions come out below the surface, and ggxPdf
// is their density too.
float ggxPdf(const glm::vec2& alpha, const glm::vec3& v, const glm::vec3& s);
glm::vec3 sampleGgx(const glm::vec2& alpha, const glm::vec3& v, const glm::vec2& u);

// Lifts a view to kLeastCosine and keeps its direction along the plane.
glm::vec3 liftedView(const glm::vec3& v);

struct Reflector {
  glm::mat3 world_from_local{1.0f};
  glm::vec3 view{0.0f, 0.0f, 1.0f};  // lifted
  glm::vec3 diffuse{0.0f};           // albedo of the diffuse part, towards this view
  glm::vec3 f0{0.0f};
  float f90 = 0.0f;
  glm::vec2 alpha{1.0f};
  const WholeBrdf* whole = nullptr;  // takes the place of all but frame and view
  float specular_share = 1.0f;       // of the directions that sample() draws

  // Returns f times the cosine; 0 if s is below the surface.
  glm::vec3 value(const glm::vec3& s) const;
  float pdf(const glm::vec3& s) const;
  glm::vec3 sample(float choice, const glm::vec2& u) const;
  // Returns the part of value() that is not diffuse.
  glm::vec3 specular(const glm::vec3& s) const;

  // Multiplies by the transpose.
  glm::vec3 toLocal(const glm::vec3& world) const { return world * world_from_local; }
};

}  // namespace lambent::baker::reference
