// Owns the shadow maps of key lights (lighting/key_lights.hpp), each of which covers the part of the world
// that is seen, and what the surface pass reads to shade with them. A map is drawn again only when its light
// turned, something in it moved, arrived or went, or the camera sees something outside it. Maps are tiles of
// one depth texture; sharp lights have fine maps, wide lights, which blur, coarse ones. A pyramid of least
// and greatest depths tells for most pixels that they are wholly lit or wholly in shadow. Render thread only.
// update() fails if a shader does not compile on this device.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/draws/surface_module.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/shadows/key_shared.h"
#include "runtime/shadows/shadow_casters.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/distant_lights.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// Computes which part of the world a key light's shadow map must show: the part that the camera sees, as seen
// from the light, and what stands between that and the light. World axes, metres. No GL.

// Returns the corners of the intersection of the box and the camera's frustum; empty if they do not meet.
std::vector<glm::dvec3> seenCorners(const scene::Box& box, const glm::mat4& clip_from_world);

// Describes an orthographic view along `towards` (unit, to the light); right, up and towards are
// right-handed. The map covers min to max along right and up, and depths from `top` down to `top - range`.
struct KeyRegion {
  glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, towards{0, 0, 1};
  glm::dvec2 min{0.0}, max{0.0};
  double top = 0.0, range = 0.0;

  // Sets min and max to the smallest area that shows these points and everything up to `top` that may block
  // their light.
  void enclose(std::span<const glm::dvec3> seen, double tan_radius);
  // Returns whether this region contains all of `other`.
  bool holds(const KeyRegion& other) const;
  double area() const { return (max.x - min.x) * (max.y - min.y); }
};

// Returns a region rotated about the light so that it is small, or nothing if there is nothing to see.
// Blockers reach up to `top` (along towards), and light also comes from directions up to tan_radius beside
// it, which widens the region.
std::optional<KeyRegion> regionOf(std::span<const glm::dvec3> seen, glm::dvec3 towards, double tan_radius,
                                  const scene::Box& casters);

struct KeyShadowOptions {
  std::uint32_t finest = 4096;  // texels along an edge of the finest map; a power of two, 256..8192
  std::uint32_t samples = 32;   // rays per disc, 4..128
  bool operator==(const KeyShadowOptions&) const = default;
};

class KeyShadows final : public SurfaceModule {
 public:
  KeyShadows();

  // Call it after World::updateTransforms(). `keys` are in world axes, at most kMostKeyLights of them count,
  // and dark ones take no map. Changes the bound framebuffer, viewport and program.
  Result<void> update(World& world, std::span<const spec::Disc> keys, const spec::View& view,
                      const KeyShadowOptions& options, gpu::Counters& counters);
  // Binds what the surface shaders read, for a picture of this size. Call it before Surfaces draws.
  void bind(const spec::View& view, const spec::Size& size) const;

  // Returns whether any key light shines.
  bool any() const { return !maps_.empty(); }
  bool reaches(std::size_t, const SurfaceDraw& record) const override { return any() && record.unlit == 0; }
  std::uint64_t version() const override { return any() ? 1 : 0; }
  std::uint32_t mapsDrawn() const { return maps_drawn_; }  // by the last update
  std::uint64_t bytesResident() const;
  struct Map {
    spec::Disc light;                      // in world axes
    std::uint32_t x = 0, y = 0, size = 0;  // its tile, in texels
    KeyRegion region;
    std::vector<ShadowCaster> casters;
    bool drawn = false;
  };
  const std::vector<Map>& maps() const { return maps_; }
  void forget() {
    for (Map& map : maps_) map.drawn = false;
  }

 private:
  void layOut(std::span<const spec::Disc> keys);
  Result<void> compile();
  std::vector<std::size_t> findChanged(World& world, const spec::View& view);
  void drawMaps(World& world, const std::vector<std::size_t>& changed, gpu::Counters& counters);
  void makePyramid(const std::vector<std::size_t>& changed, gpu::Counters& counters);

  KeyShadowOptions options_;
  std::vector<Map> maps_;
  ShadowCasters casters_{"key shadows", "key_caster.vert", "key_caster.frag"};
  scene::Box bounds_ws_;  // of all casters
  gpu::Program pyramid_program_;
  gpu::Texture blockers_;
  mutable gpu::Table block_;  // what bind() says of its view, which is no state of the shadows
  std::uint32_t maps_drawn_ = 0;
};

}  // namespace lambent::frame
