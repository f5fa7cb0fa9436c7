// Direct light of near lights (lighting/near_light.hpp): their shadow cubes, and what the surface pass reads
// to shade by them. Comes in: the world, up to kMaxNearLights lights, and which of them light the draws of
// each rigid group per pixel. A cube is drawn again only when its light or something that it sees has moved,
// arrived or gone; it holds all resident opaque and masked draws of all groups, both sides of each. Cubes lie
// in one depth texture, six tiles in a row for each light; depth is distance over the light's reach. Render
// thread only. Errors: shaders that do not compile on this device.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>

#include "runtime/base/result.hpp"
#include "runtime/frame/draw_indices.hpp"
#include "runtime/frame/near_shared.h"
#include "runtime/frame/surface_record.hpp"
#include "runtime/frame/texture_units.hpp"
#include "runtime/frame/world.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/near_light.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/size.hpp"

namespace lambent::frame {

struct NearOptions {
  std::uint32_t size = 512;    // texels along an edge of a cube's face, 16..4096
  std::uint32_t samples = 16;  // points on a light with an extent, 1..256
};

class NearLights {
 public:
  explicit NearLights(const NearOptions& options = {});

  // Lights beyond the first kMaxNearLights are left out. mask_of_group, in the order of residency().groups(),
  // says with bit k that light k lights the group's draws; groups beyond its end have none. After
  // World::updateTransforms. Changes the bound framebuffer, viewport and program.
  Result<void> update(World& world, std::span<const lighting::NearLight> lights,
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
  // What is drawn into a cube; the same casters make the same cube.
  struct Caster {
    std::uint32_t draw = 0;
    std::uint64_t id = 0;  // of the draw
    glm::mat4 world_from_mesh{1.0f};
    scene::Box bounds_ws;
    gpu::Allocation block;
    bool masked = false;
    std::uint32_t image_levels = 0;           // that have arrived
    float alpha = 1.0f, alpha_cutoff = 0.0f;  // of masked ones
    bool operator==(const Caster& other) const;
  };
  struct Cube {  // as last drawn
    lighting::NearLight light;
    std::vector<Caster> casters;
    float reach = 0.0f;
    bool drawn = false;
  };
  struct Masks {
    std::vector<std::uint32_t> of_group;
    std::uint32_t shining = 0;
    std::uint64_t residency = 0, transforms = 0;
    bool operator==(const Masks&) const = default;
  };
  // Casters that may go into one multi-draw.
  struct State {
    std::uint32_t geometry_page = 0;
    bool masked = false;
    SurfaceTextures textures;
    auto operator<=>(const State&) const = default;
  };
  struct Run {
    std::uint32_t tile = 0;  // 6 * light + face
    State state;
    std::uint32_t first_command = 0, command_count = 0;
  };

  void updateMasks(const World& world, std::span<const std::uint32_t> mask_of_group, gpu::Counters& counters);
  Result<void> compile();
  void makeRoom(std::uint32_t rows);
  void collectCasters(const World& world);
  // The lights whose cubes must be drawn; says what stands in them.
  std::vector<std::uint32_t> findChanged(World& world);
  void appendRuns(const World& world, std::uint32_t light, std::vector<Run>& runs,
                  std::vector<DrawCommand>& commands) const;
  void drawCubes(World& world, const std::vector<std::uint32_t>& changed, gpu::Counters& counters);

  NearOptions options_;
  std::array<Cube, lighting::kMaxNearLights> cubes_;
  std::array<gpu::Program, 2> programs_;  // opaque, masked
  gpu::Texture shadows_;
  gpu::Handle<gpu::FramebufferTraits> target_;
  std::uint32_t rows_ = 0;  // of the texture: lights that have room
  gpu::Table block_, draws_table_, records_, commands_, faces_;
  DrawIndices indices_;
  TextureUnits units_;
  std::vector<NearDraw> draws_;
  Masks masks_seen_;  // what draws_ follows from
  std::vector<lighting::NearLight> lights_;
  std::vector<Caster> casters_;    // of the whole world
  std::uint32_t lights_used_ = 0;  // that shine on any group
  bool any_ = false;
  std::uint64_t version_ = 0;
  std::uint32_t cubes_drawn_ = 0;
  std::uint64_t residency_seen_ = 0, transforms_seen_ = 0, materials_seen_ = 0;
};

}  // namespace lambent::frame
