// Paths: what one pixel's samples see. At every vertex: one direction by the surface (matte: by the cosine),
// weighed against one towards discs and probes, one towards each sphere and disc of light in the scene, one
// point on an emissive triangle and one punctual light (Veach's multiple importance sampling, power
// heuristic). Where a volume scatters, its phase function stands in for the surface. With
// `--band-limit IN,OUT` the first hit's answer to the open sky is exact, and paths only find what blocks it.
// What volumes let through to the eye is exact too, so coverage has no noise.
// All samples of a pixel that are asked for together walk in step, so that their rays travel in packets. A
// pixel's samples belong to two independent replicas in turn, which gives the error of their mean without
// bias. One Integrator serves all threads.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "baker/reference/camera.hpp"
#include "baker/reference/environment.hpp"
#include "baker/reference/lamps.hpp"
#include "baker/reference/options.hpp"
#include "baker/reference/ray_tracer.hpp"
#include "baker/reference/sampler.hpp"
#include "baker/reference/shape_lights.hpp"
#include "baker/reference/volumes.hpp"

namespace lambent::baker::reference {

// Everything that light and rays meet.
struct World {
  const Surfaces& surfaces;
  const RayTracer& rays;
  const Environment& environment;
  const EmissiveTriangles& emissive;
  const std::vector<PunctualLight>& punctual;
  const std::vector<spec::LocalLight>& shapes;
  const Volumes& volumes;
  EyeRays eye;
};

struct PixelSum {
  std::array<glm::dvec3, 2> replicas{};  // sums over the samples of each
  double alpha = 0.0;                    // coverage, not a sum
  std::uint64_t rays = 0;
};

class Integrator {
 public:
  Integrator(const World& world, const Options& options) : world_(world), options_(options) {}

  // Samples first..first + count - 1 of the pixel; even ones are the first replica's.
  PixelSum pixel(std::uint32_t x, std::uint32_t y, std::uint32_t first, std::uint32_t count) const;

 private:
  struct Path {
    SurfacePoint at;  // in a medium: no normals, the medium's albedo
    glm::vec3 throughput{1.0f}, sum{0.0f};
    std::uint32_t index = 0, replica = 0;  // which point of which replica
    glm::vec3 dir{0.0f};                   // that led here, in a medium; that leads on, once it is drawn
    float pdf = 0.0f;                      // of dir, by the surface's own strategy
    bool alive = true;
    bool in_medium = false;         // where it stands
    float g = 0.0f;                 // of the medium
    bool scattered = false;         // in a medium, at any vertex
    std::uint32_t reflections = 0;  // surfaces that it has met since its first vertex
  };
  // A light's contribution that counts if nothing is in the way.
  struct Shadow {
    Ray ray;
    std::size_t path;
    glm::vec3 radiance;
    std::uint32_t light;  // which of the path's
  };
  struct Walk;  // the paths of one pixel, in step

  const World& world_;
  const Options& options_;
};

}  // namespace lambent::baker::reference
