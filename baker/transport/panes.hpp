// Says what panes (KHR_materials_transmission) pass of the light along rays. Rays go straight through them: a
// pane shifts light by less than its thickness, which neither shadows nor bounces show. Each face passes its
// share (SurfaceColors::passed), and a volume absorbs between entry and exit. Where the other face of a pane
// is missing, its length inside is KHR_materials_volume's thickness.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/transport/ray_scene.hpp"
#include "baker/transport/surface_colors.hpp"

namespace lambent::baker {

// A DimmedRay of a table reaches the sky through panes.
struct DimmedRay {
  std::uint32_t ray;
  glm::vec3 passed;
};

// Returns what the faces of one ray, nearest first, pass of the light.
glm::vec3 passedBy(std::span<const PaneHit> faces, const SurfaceColors& colors);

// Sets passed[i] to what panes pass of the light along segment i.
void passedAlong(std::span<const RaySegment> segments, const RayScene& rays, const SurfaceColors& colors,
                 std::span<glm::vec3> passed);

// Finds the panes on the rays of a sample. `blocked` and `hits` are those of RayScene::traceHits, or `hits`
// is empty. Lists the rays that reach the sky through panes, fills in what hits have passed, and adds the
// faces of panes to them, which reflect a part of the light. Hits stay in the order of the rays.
void lookThroughPanes(const SampleRays& sample, const RayScene& rays, const SurfaceColors& colors,
                      std::span<const std::uint16_t> blocked, std::vector<RayHit>& hits,
                      std::vector<DimmedRay>& dimmed);

inline float meanOf(const glm::vec3& color) {
  return (color.r + color.g + color.b) / 3.0f;
}

}  // namespace lambent::baker
