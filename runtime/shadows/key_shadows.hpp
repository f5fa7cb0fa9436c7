// Owns the shadow maps of key lights (lighting/key_lights.hpp), each of which covers the part of the world
// that is seen, and what the surface pass reads to shade with them. A map is drawn again only when its light
// turned, something in it moved, arrived or went, or the camera sees something outside it. Maps are tiles of
// one depth texture; sharp lights have fine maps, wide lights, which blur, coarse ones. A pyramid of least
// and greatest depths tells for most pixels that they are wholly lit or wholly in shadow. Render thread only.
// update() fails if a shader does not compile on this device.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/draws/surface_module.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/shadows/key_region.hpp"
#include "runtime/shadows/key_shared.h"
#include "runtime/shadows/shadow_casters.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/distant_lights.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

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
  std::uint32_t mapCount() const { return static_cast<std::uint32_t>(maps_.size()); }
  std::uint64_t bytesResident() const;
  // States what each drawn map covers, for display.
  struct ShownRegion {
    spec::Disc light;  // in world axes
    KeyRegion region;
    std::uint32_t texels = 0;  // along an edge
  };
  std::vector<ShownRegion> regions() const;
  void forget() {
    for (Map& map : maps_) map.drawn = false;
  }

 private:
  struct Map {
    spec::Disc light;
    std::uint32_t x = 0, y = 0, size = 0;  // its tile, in texels
    KeyRegion region;
    std::vector<ShadowCaster> casters;
    bool drawn = false;
  };

  void layOut(std::span<const spec::Disc> keys);
  Result<void> compile();
  std::vector<std::size_t> findChanged(World& world, const spec::View& view);
  void drawMaps(World& world, const std::vector<std::size_t>& changed, gpu::Counters& counters);
  void makePyramid(const std::vector<std::size_t>& changed, gpu::Counters& counters);

  KeyShadowOptions options_;
  std::vector<Map> maps_;
  ShadowCasters casters_{"key casters"};
  scene::Box bounds_ws_;  // of all casters
  ShadowCasters::Programs programs_;
  gpu::Program pyramid_program_;
  gpu::Texture depths_, blockers_;
  gpu::Handle<gpu::FramebufferTraits> target_;
  gpu::Table views_;
  mutable gpu::Table block_;  // what bind() says of its view, which is no state of the shadows
  std::uint32_t maps_drawn_ = 0;
};

}  // namespace lambent::frame
