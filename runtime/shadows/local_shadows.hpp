// Owns the shadow cubes of local lights (lighting/local_light.hpp) and what the surface pass reads to
// shade with them. It takes the world, up to kMaxShadowedLights lights, and which of them light the draws of
// each rigid group per pixel. A cube is drawn again only when its light or something in it has moved, arrived
// or gone; it holds all resident opaque and masked draws of all groups, both sides of each. All cubes are
// tiles of one depth texture, six in a row per light; depth is distance over the light's reach. Render thread
// only. update() fails if a shader does not compile on this device.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/draws/surface_module.hpp"
#include "runtime/lighting/local_light.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/shadows/local_shared.h"
#include "runtime/shadows/shadow_casters.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// Defines the six faces of a shadow cube as local_shadow.glsl looks them up: +X, -X, +Y, -Y, +Z, -Z, each a
// camera along its axis with a field of view of 90 degrees. Boxes are relative to the cube's centre.
struct FaceAxes {
  glm::vec3 right, up, forward;
};

inline FaceAxes faceAxes(std::uint32_t face) {
  glm::vec3 forward(0.0f);
  forward[static_cast<int>(face / 2)] = face % 2 == 1 ? -1.0f : 1.0f;
  const glm::vec3 up = face / 2 == 1 ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
  return {glm::cross(forward, up), up, forward};
}

// Return the least and the greatest dot(axis, x) over the box.
inline float leastAlong(const scene::Box& box, glm::vec3 axis) {
  float sum = 0.0f;
  for (int i = 0; i < 3; ++i) sum += axis[i] * (axis[i] > 0.0f ? box.min[i] : box.max[i]);
  return sum;
}
inline float mostAlong(const scene::Box& box, glm::vec3 axis) {
  return -leastAlong(box, -axis);
}

// Returns whether part of the box may lie in the face's frustum; at its edges it may return true for boxes
// outside.
inline bool faceMeets(const FaceAxes& axes, const scene::Box& box) {
  for (const glm::vec3 side : {axes.right, -axes.right, axes.up, -axes.up})
    if (mostAlong(box, axes.forward + side) < 0.0f) return false;
  return true;
}

// Return the distance of the box's nearest and farthest point from the centre.
inline float nearestDistance(const scene::Box& box) {
  return glm::length(glm::max(glm::max(box.min, -box.max), glm::vec3(0.0f)));
}
inline float farthestDistance(const scene::Box& box) {
  return glm::length(glm::max(glm::abs(box.min), glm::abs(box.max)));
}

struct LocalOptions {
  std::uint32_t size =
      512;  // texels along an edge of a cube's face, 16..4096; more than four cubes are smaller
  std::uint32_t samples = 16;  // sample points on a light with an extent, 1..256
};

class LocalShadows final : public SurfaceModule {
 public:
  explicit LocalShadows(const LocalOptions& options = {});

  // Lights beyond the first kMaxShadowedLights are ignored. Bit k of mask_of_group, indexed as
  // residency().groups(), tells that light k lights the group's draws; groups beyond its end have no light.
  // A light whose entry in `own_lamps` is not null does not light the draws of that emissive material
  // (World::lampOfDraw()). Call it after World::updateTransforms(). Changes the bound framebuffer, viewport
  // and program.
  Result<void> update(World& world, std::span<const lighting::LocalLight> lights,
                      std::span<const std::uint32_t> mask_of_group, gpu::Counters& counters,
                      std::span<const ecs::Entity> own_lamps = {});

  // Binds what the surface shaders read, for a picture of this size and view. Call it before Surfaces draws;
  // it binds nothing if no draw is lit.
  void bind(const spec::View& view, const spec::Size& size) const;

  // Returns the lights of a draw of the residency: bit k is set if light k lights it.
  std::uint32_t lightsOf(std::size_t draw) const { return draw < draws_.size() ? draws_[draw].lights : 0; }
  bool any() const { return any_; }
  bool reaches(std::size_t draw, const SurfaceDraw&) const override { return lightsOf(draw) != 0; }
  std::uint64_t version() const override { return version_; }
  // Makes the next update draw all cubes.
  void forget() {
    for (Cube& cube : cubes_) cube.drawn = false;
  }
  // Returns how many cubes the last update drew.
  std::uint32_t cubesDrawn() const { return cubes_drawn_; }

 private:
  struct Cube {  // as last drawn
    lighting::LocalLight light;
    std::vector<ShadowCaster> casters;
    float reach = 0.0f;
    bool drawn = false;
  };
  void updateMasks(const World& world, std::span<const std::uint32_t> mask_of_group, gpu::Counters& counters);
  void makeRoom(std::uint32_t rows);
  // Returns the lights whose cubes must be drawn, and records their casters.
  std::vector<std::uint32_t> findChanged(World& world);
  void drawCubes(World& world, const std::vector<std::uint32_t>& changed, gpu::Counters& counters);

  LocalOptions options_;
  std::array<Cube, lighting::kMaxShadowedLights> cubes_;
  ShadowCasters casters_{"local shadows", "local_caster.vert", "local_caster.frag"};
  std::uint32_t rows_ = 0;    // rows of the texture, one per light
  std::uint32_t size_ = 0;    // texels along an edge of a face
  mutable gpu::Table block_;  // what bind() says of its view, which is no state of the shadows
  gpu::Table draws_table_;
  std::vector<LocalDraw> draws_;
  // draws_ follows from the groups' masks, the materials that shine as lights, the lights that shine,
  // residency and transforms.
  ChangeGate<std::vector<std::uint32_t>, std::vector<ecs::Entity>, std::uint32_t, std::uint64_t,
             std::uint64_t>
      masks_changed_;
  std::vector<ecs::Entity> own_lamps_;  // one per light
  std::vector<lighting::LocalLight> lights_;
  std::uint32_t lights_used_ = 0;  // how many shine on any group
  bool any_ = false;
  std::uint64_t version_ = 0;
  std::uint32_t cubes_drawn_ = 0;
};

}  // namespace lambent::frame
