// Holds a rigid group as rays see it: its geometry and samples, the ray hierarchy, the colours of its
// surfaces and the lights that belong to it. All of it is borrowed.
#pragma once

#include <span>

#include "baker/importance/importance.hpp"
#include "baker/trace/mirror_paths.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/samples.hpp"
#include "baker/transport/surface_colors.hpp"

namespace lambent::baker {

// Everything that a TracedScene refers to must outlive the bake.
struct TracedScene {
  const Scene& scene;
  const GroupGeometry& geometry;
  const SampleSet& samples;
  const RayScene& rays;
  const SurfaceColors& colors;
  std::span<const PlannedLight> lights;
  const MirrorPaths* mirrors = nullptr;  // null if no surface is glossy or layered
  // False if no part of the group hides light from another (planned_transport.hpp): samples see all that is
  // above the horizons of their faces.
  bool shadows = true;
  const SampleImportance* importance = nullptr;  // of the samples; null: all count alike

  // Returns whether pictures show anything of a triangle, or of light that it sends.
  bool matters(std::uint32_t triangle) const {
    const glm::uvec3 corners = geometry.triangles[triangle];
    const auto corner = [&](int c) { return importance->matters(samples.vertex_sample[corners[c]]); };
    return !importance || corner(0) || corner(1) || corner(2);
  }

  TracedScene withSamples(const SampleSet& others) const {
    return {scene, geometry, others, rays, colors, lights, mirrors, shadows, nullptr};
  }
};

}  // namespace lambent::baker
