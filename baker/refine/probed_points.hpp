// Remembers what a group's points were found to be hidden from, and what light surfaces send them, over all
// rounds of refinement. Triangles change between rounds, but surfaces stay in place, so that most points are
// known already.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/jobs/bake_context.hpp"
#include "baker/refine/shadow_probe.hpp"
#include "baker/refine/surface_light.hpp"
#include "baker/transport/geometry_key.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

inline constexpr std::size_t kPointsPerRange = 64;  // probed points in one range of work

// A ProbedScene is the group before any split, as points see it.
struct ProbedScene {
  Key key;
  const RayScene& rays;
  const SurfaceLight& light;
};

class ProbedPoints {
 public:
  // The probe outlives this.
  explicit ProbedPoints(const ShadowProbe& probe) : probe_(&probe) {}

  const ShadowProbe& shadowProbe() const { return *probe_; }

  // Returns the number of a point. New points must be probed before they are asked about.
  std::uint32_t numberOf(const glm::vec3& position, const glm::vec3& normal, SampleKind kind,
                         std::span<const SampleOrigin> origins);
  // Traces rays from all new points. Returns false when stopped.
  bool probe(const ProbedScene& scene, const BakeContext& context);

  std::span<const std::uint16_t> masksAt(std::uint32_t point) const {
    return std::span(masks_).subspan(point * probe_->packets(), probe_->packets());
  }
  const SentLight& lightAt(std::uint32_t point) const { return light_[point]; }
  bool seen(std::uint32_t point) const { return seen_[point] != 0; }
  std::uint64_t raysTraced() const { return traced_; }
  std::uint64_t raysKept() const { return kept_; }

 private:
  struct Point {
    glm::vec3 normal{0.0f};
    SampleKind kind = SampleKind::Diffuse;
    std::vector<SampleOrigin> origins;
  };

  const ShadowProbe* probe_;
  std::unordered_map<VertexKey, std::uint32_t, VertexKeyHash> known_;
  std::vector<Point> missing_;        // those that follow the ones in seen_
  std::vector<std::uint16_t> masks_;  // ShadowProbe::packets() for each point
  std::vector<SentLight> light_;
  std::vector<std::uint8_t> seen_;  // 1 if the point can be seen at all
  std::uint64_t traced_ = 0, kept_ = 0;
};

}  // namespace lambent::baker
