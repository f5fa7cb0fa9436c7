// Gathers light that the group itself emits, at unit strength, in one column per light. Emissive surfaces are
// sampled by next-event estimation combined with the sample's own rays (multiple importance sampling with the
// balance heuristic: Veach 1995), punctual lights by one shadow ray per origin. The points on the surfaces
// are low-discrepancy and the same for all samples, so errors are smooth in space.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>

#include "baker/cache/key.hpp"
#include "baker/plan/group_lights.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/surface_colors.hpp"

namespace lambent::baker {

// A LightReceiver is a sample on which light arrives. Its local frame has the normal along z.
class LightReceiver {
 public:
  virtual ~LightReceiver() = default;
  // Returns the unit direction of one of the sample's own rays, in the local frame.
  virtual glm::vec3 direction(std::size_t ray) const = 0;
  virtual float raysPerSteradian(float cosine) const = 0;
  // Adds radiance along one of those rays.
  virtual void addAlong(std::size_t ray, std::uint32_t light, glm::vec3 radiance) = 0;
  // Adds radiance times solid angle from a local direction with z > 0.
  virtual void addFrom(glm::vec3 local, std::uint32_t light, glm::vec3 radiance) = 0;
};

class Emitters {
 public:
  // `points` is about the number of points on all emitters together.
  Emitters(const Scene& scene, const GroupGeometry& geometry, const SurfaceColors& colors,
           std::span<const PlannedLight> lights, std::size_t points = 1024);

  bool empty() const { return surfaces_.empty() && punctual_.empty(); }

  // Adds emitted light that the sample's rays hit (hits of RayScene::traceHits).
  void addMet(std::span<const RayHit> hits, std::span<const SampleOrigin> origins, const glm::mat3& frame,
              LightReceiver& receiver) const;
  // Adds light from points chosen on the emitters, and from punctual lights.
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
    glm::vec3 position, direction;  // group frame; the direction, unit, in which light shines
  };

  void choosePoints(std::size_t count, Surface& surface, const std::vector<std::uint32_t>& triangles) const;

  const GroupGeometry& geometry_;
  const SurfaceColors& colors_;
  std::vector<Surface> surfaces_;
  std::vector<Punctual> punctual_;
  std::vector<std::int32_t> surface_of_light_;  // index of a light -> index in surfaces_, or -1
};

// Adds where the lights of the group shine from, at unit strength, and the textures that scale emission.
void addLights(const Scene& scene, const GroupGeometry& geometry, std::span<const PlannedLight> lights,
               KeyMaker& key);

// Returns the irradiance on a surface that faces a punctual light of unit strength: its intensity in the
// direction `to_surface`, over the squared distance (KHR_lights_punctual). `to_surface` reaches from the
// light to the surface.
float punctualIrradiance(const gltf::Light& light, glm::vec3 light_direction, glm::vec3 to_surface);

}  // namespace lambent::baker
