// Follows rays from surfaces of metal that are sharper than the bands of an exit kernel can represent, until
// they meet another surface or leave the group. The hits of a range of samples come in; in place of those on
// sharp surfaces stand what the paths met: hits on diffuse surfaces, whose albedo holds the colour of the
// mirrors before them, and MirroredLight for all else. So bands limit the light that a mirror passes on, and
// not the mirror, and a caustic is as sharp as the light. Hits on smooth dielectrics stay, with the albedo of
// the base, and some rays are followed by way of the layer over it. A path follows from its sample, ray and
// hit alone, so hits that are traced again are the same. Calls are safe from any thread.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include <glm/vec3.hpp>

#include "baker/brdf/surface_brdfs.hpp"
#include "baker/trace/hits.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/surface_colors.hpp"

namespace lambent::baker {

// Light is followed through highlights of surfaces that are smoother than this. Seven bands carry less than
// half of the energy of a highlight of this roughness (lobeEnergyShare), and almost nothing of a polished
// one.
inline constexpr float kMirrorRoughness = 0.25f;

// Returns the unit direction of a ray of a sample, which is counted from the first of its range.
using RayDirection = std::function<glm::vec3(std::size_t sample, std::uint32_t ray)>;

class MirrorPaths {
 public:
  // All arguments must outlive this. `with_lights` says that the group has lights of its own.
  MirrorPaths(const GroupGeometry& geometry, const RayScene& rays, const SurfaceColors& colors,
              const SurfaceBrdfs& brdfs, bool with_lights)
      : geometry_(geometry), rays_(rays), colors_(colors), brdfs_(brdfs), with_lights_(with_lights) {}

  // Follows the painted hits of samples that begin with `first_sample`. `passed` says what panes before each
  // hit pass of the light, which is not in the colours of the hits yet; it is empty if there are no panes.
  void follow(std::size_t first_sample, const RayDirection& direction, std::span<const glm::vec3> passed,
              RangeHits& hits) const;

 private:
  class Walk;
  bool isSharp(const GatherHit& hit) const;
  // Leaves a hit on a layer, met along this direction, to the base under it. Returns the share of light that
  // the layer reflects there; of a pane, that at a right angle, as it also passes light (SurfaceColors).
  float leaveBase(const glm::vec3& along, GatherHit& hit) const;

  const GroupGeometry& geometry_;
  const RayScene& rays_;
  const SurfaceColors& colors_;
  const SurfaceBrdfs& brdfs_;
  bool with_lights_;
};

}  // namespace lambent::baker
