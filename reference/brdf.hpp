// How a place reflects, towards one view (docs/conventions.md, "Materials"): GGX with Fresnel over a diffuse
// part, round or anisotropic, or a measured BRDF. Values, densities and directions are local: z the shading
// normal, x the tangent; v and s point away from the surface. Shares nothing with baker/brdf but the loader
// of measured files: the reference is to find its mistakes.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace lambent::baker::reference {

class MeasuredReflection;

inline constexpr float kLeastAlpha = 0.001f;
// Of a view: what looks from lower counts as from here.
inline constexpr float kLeastCosine = 0.001f;

// Along the tangent and across it.
glm::vec2 ggxAlpha(float roughness, float strength);

// f times the cosine of s, without Fresnel's factor: x is what F0 multiplies, y what F90 does. 0 where s.z <=
// 0.
glm::vec2 ggxValue(const glm::vec2& alpha, const glm::vec3& v, const glm::vec3& s);
// By the normals that v sees (Heitz 2018); some directions come out below the surface, and have their density
// too.
float ggxPdf(const glm::vec2& alpha, const glm::vec3& v, const glm::vec3& s);
glm::vec3 sampleGgx(const glm::vec2& alpha, const glm::vec3& v, const glm::vec2& u);

// The view as BRDFs take it: lifted to kLeastCosine, its direction along the plane kept.
glm::vec3 liftedView(const glm::vec3& v);

struct Reflector {
  glm::mat3 world_from_local{1.0f};
  glm::vec3 view{0.0f, 0.0f, 1.0f};  // lifted
  glm::vec3 diffuse{0.0f};           // albedo of the diffuse part, towards this view
  glm::vec3 f0{0.0f};
  float f90 = 0.0f;
  glm::vec2 alpha{1.0f};
  const MeasuredReflection* measured = nullptr;  // takes the place of all but frame and view
  float specular_share = 1.0f;                   // of the directions that sample() draws

  // f times the cosine; s below the surface gets nothing.
  glm::vec3 value(const glm::vec3& s) const;
  float pdf(const glm::vec3& s) const;
  glm::vec3 sample(float choice, const glm::vec2& u) const;
  // The part that is no Lambert surface.
  glm::vec3 specular(const glm::vec3& s) const;

  glm::vec3 toLocal(const glm::vec3& world) const { return world * world_from_local; }  // by the transpose
};

}  // namespace lambent::baker::reference
