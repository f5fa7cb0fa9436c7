// Remembers what a group's points were found to be hidden from, and what light surfaces send them, over all
// rounds of refinement. Triangles change between rounds, but surfaces stay in place, so that most points are
// known already.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/importance/importance.hpp"
#include "baker/jobs/bake_context.hpp"
#include "baker/trace/emitters.hpp"
#include "baker/transport/geometry_key.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

// Finds what is hidden from a surface point, as one bit for each of many directions, and how wrong it is to
// show a mixture of other points' bits instead: the transfer that interpolation over triangles gets wrong.
// All points use the same directions, so that neighbours which see the same have no difference.

// HiddenFrom holds what one point sees, and its weight in a mixture.
struct HiddenFrom {
  std::span<const std::uint16_t> masks;  // ShadowProbe::packets() values
  glm::vec3 normal{0.0f};                // unit shading normal
  float share = 1.0f;
};

class ShadowProbe {
 public:
  // `rays` go over the whole sphere; their number is rounded up to whole packets in each of its quarters.
  explicit ShadowProbe(std::size_t rays);

  std::size_t rays() const { return directions_.size(); }
  std::size_t packets() const { return directions_.packets(); }

  // Fills in which directions are hidden. For a diffuse sample, directions below its faces are hidden too;
  // for a glossy or normal-mapped one, directions below the normal are mirrored, as in its transfer. Returns
  // false if the point stands where it cannot be seen.
  bool look(const RayScene& scene, std::span<const SampleOrigin> origins, const glm::vec3& normal,
            SampleKind kind, std::span<std::uint16_t> masks) const;

  // Returns how the mixture of `corners` differs from `truth`, as seen by each half of the directions. The
  // product of both halves (squareError) is the mean square error over real lights of showing one instead of
  // the other, relative to the light of an open point: of the irradiance, or of what glossy surfaces reflect.
  // It has no bias from too few rays, and may therefore come out a little below 0.
  static constexpr std::size_t kMostValues = 81;  // diffuse samples use fewer, the rest is 0
  using Difference = std::array<std::array<float, kMostValues>, 2>;
  Difference difference(std::span<const HiddenFrom, 3> corners, const HiddenFrom& truth,
                        SampleKind kind) const;
  // Returns what arrives at a point in the same way: its square is the mean square of the light there.
  Difference arriving(const HiddenFrom& point, SampleKind kind) const;
  static double squareError(const Difference& difference);
  // Returns the irradiance by uniform light, relative to that of an open point, 0..1.
  float openShare(const HiddenFrom& point) const;

 private:
  // Returns harmonics of a direction, scaled so that the square of their sum over what is wrongly hidden is
  // an error.
  std::span<const float> row(std::size_t direction, bool plain) const;

  // Two halves with patterns of their own, because errors are products of what each half shows.
  DirectionTable directions_;
  InsideTestTables inside_test_;
  std::vector<float> irradiance_, visibility_;
};

// Estimates the light that surfaces of a group send to its points: that of its lamps, each as bright as the
// others where eyes look, and the first bounce of a uniform sky, off surfaces that reflect half of it. So the
// meshes stay as they are when colours are edited. The same few shadow rays serve all points (instant
// radiosity; Keller 1997), so that neighbours which see the same have no difference.

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
