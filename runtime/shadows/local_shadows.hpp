// Direct light of local lights (lighting/shadowed_light.hpp): their shadow cubes, and what the surface pass
// reads to shade by them. Comes in: the world, up to kMaxShadowedLights lights, and which of them light the
// draws of each rigid group per pixel. A cube is drawn again only when its light or something that it sees
// has moved, arrived or gone; it holds all resident opaque and masked draws of all groups, both sides of
// each. Cubes lie in one depth texture, six tiles in a row for each light; depth is distance over the light's
// reach. Render thread only. Errors: shaders that do not compile on this device.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>

#include "runtime/base/result.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/shadowed_light.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/shadows/local_shared.h"
#include "runtime/shadows/shadow_casters.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/size.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

struct LocalOptions {
  std::uint32_t size = 512;    // texels along an edge of a cube's face, 16..4096
  std::uint32_t samples = 16;  // points on a light with an extent, 1..256
};

class LocalShadows {
 public:
  explicit LocalShadows(const LocalOptions& options = {});

  // Lights beyond the first kMaxShadowedLights are left out. mask_of_group, in the order of
  // residency().groups(), says with bit k that light k lights the group's draws; groups beyond its end have
  // none. After World::updateTransforms. Changes the bound framebuffer, viewport and program.
  Result<void> update(World& world, std::span<const lighting::ShadowedLight> lights,
                      std::span<const std::uint32_t> mask_of_group, gpu::Counters& counters);

  // What the surface shaders read, for a picture of this size seen so. Before Surfaces draws; nothing is
  // bound where no draw is lit.
  void bind(const spec::View& view, const spec::Size& size);

  // Bit k: the residency's draw is lit by light k.
  std::uint32_t lightsOf(std::size_t draw) const { return draw < draws_.size() ? draws_[draw].lights : 0; }
  bool any() const { return any_; }
  // Rises when lightsOf changes for any draw.
  std::uint64_t version() const { return version_; }
  // All cubes are drawn anew.
  void forget() {
    for (Cube& cube : cubes_) cube.drawn = false;
  }
  // How many cubes the last update drew.
  std::uint32_t cubesDrawn() const { return cubes_drawn_; }
  std::uint64_t bytesResident() const;

 private:
  struct Cube {  // as last drawn
    lighting::ShadowedLight light;
    std::vector<ShadowCaster> casters;
    float reach = 0.0f;
    bool drawn = false;
  };
  struct Masks {
    std::vector<std::uint32_t> of_group;
    std::uint32_t shining = 0;
    std::uint64_t residency = 0, transforms = 0;
    bool operator==(const Masks&) const = default;
  };
  void updateMasks(const World& world, std::span<const std::uint32_t> mask_of_group, gpu::Counters& counters);
  Result<void> compile();
  void makeRoom(std::uint32_t rows);
  // The lights whose cubes must be drawn; says what stands in them.
  std::vector<std::uint32_t> findChanged(World& world);
  void drawCubes(World& world, const std::vector<std::uint32_t>& changed, gpu::Counters& counters);

  LocalOptions options_;
  std::array<Cube, lighting::kMaxShadowedLights> cubes_;
  ShadowCasters casters_{"shadow casters"};
  ShadowCasters::Programs programs_;
  gpu::Texture shadows_;
  gpu::Handle<gpu::FramebufferTraits> target_;
  std::uint32_t rows_ = 0;  // of the texture: lights that have room
  gpu::Table block_, draws_table_, faces_;
  std::vector<LocalDraw> draws_;
  Masks masks_seen_;  // what draws_ follows from
  std::vector<lighting::ShadowedLight> lights_;
  std::uint32_t lights_used_ = 0;  // that shine on any group
  bool any_ = false;
  std::uint64_t version_ = 0;
  std::uint32_t cubes_drawn_ = 0;
};

}  // namespace lambent::frame
