// Light that the group gives off itself, at unit strength, one column each: emissive surfaces by next-event
// estimation combined with the sample's own rays (multiple importance sampling, balance heuristic: Veach
// 1995), punctual lights by one shadow ray per origin. Low-discrepancy points on the surfaces, the same for
// all samples, so errors are smooth in space.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>

#include "baker/plan/group_lights.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/surface_colors.hpp"

namespace lambent::baker {

// A sample as light arrives at it.
class LightReceiver {
 public:
  virtual ~LightReceiver() = default;
  // Of the rays that it looked with: local frame, z its normal.
  virtual glm::vec3 direction(std::size_t ray) const = 0;
  virtual float raysPerSteradian(float cosine) const = 0;
  // Radiance along one of those rays.
  virtual void addAlong(std::size_t ray, std::uint32_t light, glm::vec3 radiance) = 0;
  // Radiance times solid angle from a local direction with z > 0.
  virtual void addFrom(glm::vec3 local, std::uint32_t light, glm::vec3 radiance) = 0;
};

class Emitters {
 public:
  Emitters(const Scene& scene, const GroupGeometry& geometry, const SurfaceColors& colors,
           std::span<const PlannedLight> lights);

  bool empty() const { return surfaces_.empty() && punctual_.empty(); }

  // Light that the sample's rays met (hits of RayScene::traceHits).
  void addMet(std::span<const RayHit> hits, std::span<const SampleOrigin> origins, const glm::mat3& frame,
              LightReceiver& receiver) const;
  // Light from points chosen on the emitters, and from punctual lights.
  void addChosen(std::span<const SampleOrigin> origins, const glm::mat3& frame, const RayScene& rays,
                 LightReceiver& receiver) const;

 private:
  struct Point {
    glm::vec3 position, normal, radiance;
  };
  struct Surface {  // all emitting triangles of one column
    std::uint32_t light = 0;
    float area = 0.0f;
    std::vector<Point> points;
  };
  struct Punctual {
    std::uint32_t light = 0;
    gltf::Light source;
    glm::vec3 position, direction;  // unit, the way that the light shines
  };

  void choosePoints(std::size_t count, Surface& surface, const std::vector<std::uint32_t>& triangles) const;
  float chosenShare(float rays_per_steradian, float points_per_steradian) const {
    return points_per_steradian / (points_per_steradian + rays_per_steradian);
  }

  const GroupGeometry& geometry_;
  const SurfaceColors& colors_;
  std::vector<Surface> surfaces_;
  std::vector<Punctual> punctual_;
  std::vector<std::int32_t> surface_of_light_;  // light -> place in surfaces_, -1
};

// Intensity of a punctual light of unit strength towards `direction` from it, over the squared distance: the
// irradiance on a surface that faces it (KHR_lights_punctual).
float punctualIrradiance(const gltf::Light& light, glm::vec3 light_direction, glm::vec3 to_surface);

}  // namespace lambent::baker
