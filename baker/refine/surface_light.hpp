// Estimates the light that surfaces of a group send to its points: that of its lamps, each as bright as the
// others where eyes look, and the first bounce of a uniform sky, off surfaces that reflect half of it. So the
// meshes stay as they are when colours are edited. The same few shadow rays serve all points (instant
// radiosity; Keller 1997), so that neighbours which see the same have no difference.
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/importance/importance.hpp"
#include "baker/refine/shadow_probe.hpp"
#include "baker/trace/emitters.hpp"

namespace lambent::baker {

// SentLight is irradiance over pi, or the same relative to that of an open point under the same sky.
struct SentLight {
  float lamps = 0.0f;    // directly and by the first bounce
  float bounced = 0.0f;  // of a uniform sky
};

template <>
inline constexpr bool kPlainBytes<SentLight> = true;

class SurfaceLight {
 public:
  // All arguments but `lights` must outlive this. Lamps that are shaded per pixel, because they have shadow
  // cubes, send only what they bounce.
  SurfaceLight(const Scene& scene, const GroupGeometry& geometry, const RayScene& rays,
               const SurfaceColors& colors, std::span<const PlannedLight> lights,
               const Importance& importance, const ShadowProbe& probe);

  SentLight at(std::span<const SampleOrigin> origins, const glm::vec3& normal) const;
  // Return the light of a uniform sky, relative to that of an open point, and of all lamps, as eyes see them
  // on average.
  float meanSky() const { return mean_sky_; }
  float meanLamps() const { return mean_lamps_; }

 private:
  struct Bouncer {  // a point that eyes see, as a small disc that reflects
    glm::vec3 position, normal;
    float area = 0.0f;   // m^2
    float sky = 0.0f;    // what it reflects of a uniform sky, relative to an open white surface
    float lamps = 0.0f;  // and of the lamps
  };
  SentLight bouncedAt(const SampleOrigin& origin, const glm::vec3& normal) const;
  // Adds what each lamp sends, at unit strength.
  void addLamps(std::span<const SampleOrigin> origins, const glm::vec3& normal, std::span<float> sums) const;

  const RayScene& rays_;
  std::vector<float> strengths_, at_vertices_;  // of each lamp, and of those that are not shaded per pixel
  Emitters emitters_;
  std::vector<Bouncer> bouncers_;
  float mean_sky_ = 0.0f, mean_lamps_ = 0.0f;
};

}  // namespace lambent::baker
