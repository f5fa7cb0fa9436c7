// Evaluates and samples the reflection of a surface point towards one view direction (docs/conventions.md,
// "Materials"): GGX with Fresnel over a diffuse part, isotropic or anisotropic, or a measured BRDF.
// Directions are in local space: z is the shading normal, x the tangent; v and s point away from the surface.
// It shares only the loader of measured files with baker/brdf, so that it can reveal mistakes there.
#pragma once

#include <vector>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "baker/import/scene.hpp"

namespace lambent::baker::reference {

class MeasuredReflection;

inline constexpr float kLeastAlpha = 0.001f;
// The cosine of a view direction is raised to this minimum.
inline constexpr float kLeastCosine = 0.001f;

// Returns alpha along the tangent and across it.
glm::vec2 ggxAlpha(float roughness, float strength);

// Returns the BRDF times the cosine of s, without the Fresnel factors: F0 multiplies x, F90 multiplies y.
// Returns 0 if s.z <= 0.
glm::vec2 ggxValue(const glm::vec2& alpha, const glm::vec3& v, const glm::vec3& s);
// Sample the distribution of visible normals (Heitz 2018) and return its density per steradian of s. Some
// sampled directions are below the surface, and ggxPdf includes them.
float ggxPdf(const glm::vec2& alpha, const glm::vec3& v, const glm::vec3& s);
glm::vec3 sampleGgx(const glm::vec2& alpha, const glm::vec3& v, const glm::vec2& u);

// Raises the cosine of a view direction to kLeastCosine and keeps its azimuth.
glm::vec3 liftedView(const glm::vec3& v);

struct Reflector {
  glm::mat3 world_from_local{1.0f};
  glm::vec3 view{0.0f, 0.0f, 1.0f};  // liftedView() of the direction to the viewer, local
  glm::vec3 diffuse{0.0f};           // albedo of the diffuse part, for this view
  glm::vec3 f0{0.0f};
  float f90 = 0.0f;
  glm::vec2 alpha{1.0f};
  const MeasuredReflection* measured = nullptr;  // if set, replaces everything but the frame and the view
  float specular_share = 1.0f;  // probability with which sample() draws from the specular part

  // Returns the BRDF times the cosine, or 0 if s is below the surface.
  glm::vec3 value(const glm::vec3& s) const;
  float pdf(const glm::vec3& s) const;
  glm::vec3 sample(float choice, const glm::vec2& u) const;
  // Returns the specular part of value().
  glm::vec3 specular(const glm::vec3& s) const;

  // The matrix is orthonormal, so its transpose is its inverse.
  glm::vec3 toLocal(const glm::vec3& world) const { return world * world_from_local; }
};

// Tabulates the directional albedo of the GGX lobe by view direction, roughness and anisotropy, as the two
// factors of F0 and F90. The diffuse part of a material is reduced by this albedo. The reference integrates
// the table itself, with an error of 0.1 % (anisotropic: 0.5 %).

class AlbedoTable {
 public:
  AlbedoTable() = default;
  static AlbedoTable build(bool anisotropic);

  bool empty() const { return values_.empty(); }
  // Returns the factors of F0 and F90. `view` is a unit vector in local space with z > 0; roughness and
  // strength are 0..1.
  glm::vec2 at(const glm::vec3& view, float roughness, float strength) const;

 private:
  std::size_t angles_ = 0, azimuths_ = 1, roughnesses_ = 0, strengths_ = 1;
  std::vector<glm::vec2> values_;  // [strength][roughness][azimuth][angle]
};

// Interpolates a measured BRDF for the reference (docs/conventions.md, "Materials") by a weighted mean over
// the half-vector and difference angles, tabulated once. It is scaled down where it would reflect more energy
// than it receives.
class MeasuredReflection {
 public:
  explicit MeasuredReflection(const MeasuredBrdf& measured);

  // Returns the BRDF; v and s are in local space, above the surface.
  glm::vec3 value(const glm::vec3& v, const glm::vec3& s) const;
  // Returns the alpha of a GGX lobe that is about as wide as the highlight, for sampling.
  float alpha() const { return alpha_; }

 private:
  glm::vec3 unscaled(const glm::vec3& v, const glm::vec3& s) const;
  float scale(float cosine) const;

  std::vector<glm::vec3> values_;  // [theta_d][sqrt of theta_h]
  std::vector<float> scales_;      // by the square root of the cosine
  float alpha_ = 0.2f;
};

// Decides which light a glossy surface gets from directions below its own plane (docs/conventions.md,
// "Materials"). Lobes follow the smooth normal and normal maps, so parts of them can lie below the triangle.
// Such a direction gets the light of its mirror image.

// Holds two planes by their unit normals. A direction below the plane of the smooth normal (before normal
// maps) is mirrored at it; if the result is below the triangle, it is mirrored at the triangle. Rays start
// above the triangle, and each stands for all directions that are mirrored to it.
struct Horizons {
  glm::vec3 smooth{0.0f, 0.0f, 1.0f}, triangle{0.0f, 0.0f, 1.0f};

  static glm::vec3 mirrored(const glm::vec3& dir, const glm::vec3& normal) {
    return dir - 2.0f * glm::dot(dir, normal) * normal;
  }
  static glm::vec3 above(const glm::vec3& dir, const glm::vec3& normal) {
    return glm::dot(dir, normal) < 0.0f ? mirrored(dir, normal) : dir;
  }

  // Returns the ray direction for a direction, with the same length.
  glm::vec3 rayFor(const glm::vec3& dir) const { return above(above(dir, smooth), triangle); }

  // Calls visit(dir) for the directions above the smooth plane that a ray stands for. The ray also stands for
  // their mirror images in that plane.
  template <typename Visit>
  void forAbove(const glm::vec3& ray, const Visit& visit) const {
    if (glm::dot(ray, smooth) > 0.0f) visit(ray);
    if (const glm::vec3 hidden = mirrored(ray, triangle); glm::dot(hidden, smooth) > 0.0f) visit(hidden);
  }
};

}  // namespace lambent::baker::reference
