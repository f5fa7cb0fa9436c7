// Owns the shadow casters: all resident opaque and masked draws of a world, both sides of each. It draws them
// into tiles of a depth texture, for the shadow cubes of local lights and the shadow maps of key lights.
// Render thread only; it reports no errors.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <glm/mat4x4.hpp>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/draws/surface_record.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// The tables of GLSL text that programs of this room include files from.
extern const gpu::FindText kShadowShaders[2];

// Describes a caster. Casters that compare equal cast equal shadows.
struct ShadowCaster {
  std::uint32_t draw = 0;
  std::uint64_t id = 0;  // id of the draw
  glm::mat4 world_from_mesh{1.0f};
  scene::Box bounds_ws;
  gpu::Allocation block;
  bool masked = false;
  std::uint32_t image_levels = 0;           // texture levels that have arrived
  float alpha = 1.0f, alpha_cutoff = 0.0f;  // masked casters only
  bool operator==(const ShadowCaster& other) const;
};

class ShadowCasters {
 public:
  explicit ShadowCasters(std::string_view label);

  // Gathers the casters again if the world changed since the last call, and returns whether it did.
  bool follow(const World& world);
  const std::vector<ShadowCaster>& all() const { return casters_; }

  // Describes a square of the texture, and the casters drawn into it.
  struct Tile {
    std::uint32_t x = 0, y = 0, size = 0;  // in texels
    std::size_t view = 0;                  // offset in bytes of its uniform block in the buffer of views
    std::vector<const ShadowCaster*> casters;
  };
  // Holds uniform blocks, one for each tile.
  struct TileViews {
    const gpu::Buffer& buffer;
    std::size_t bytes = 0;  // size of a block
    GLuint binding = 0;
  };
  // Holds the programs for opaque casters and for masked ones, in this order.
  using Programs = std::array<gpu::Program, 2>;
  static Result<Programs> compile(std::string_view label, std::string_view vertex, std::string_view fragment);
  // Clears the tiles of the bound framebuffer's depth to 1 and draws them. Changes viewport, scissor, depth
  // and culling state.
  void draw(World& world, std::span<const Tile> tiles, const Programs& programs, const TileViews& views,
            gpu::Counters& counters);

 private:
  // Holds the state that casters must share to go into one multi-draw.
  struct State {
    std::uint32_t geometry_page = 0;
    bool masked = false;
    SurfaceTextures textures;
    auto operator<=>(const State&) const = default;
  };
  struct Run {
    std::size_t tile = 0;
    State state;
    std::uint32_t first_command = 0, command_count = 0;
  };
  static State stateOf(const World& world, const ShadowCaster& caster);
  static void appendRuns(const World& world, const Tile& tile, std::size_t index, std::vector<Run>& runs,
                         std::vector<DrawCommand>& commands);

  std::vector<ShadowCaster> casters_;
  gpu::Table records_, commands_;
  DrawIndices indices_;
  TextureUnits units_;
  ChangeGate<std::uint64_t, std::uint64_t, std::uint64_t> changed_;  // residency, transforms, materials
};

}  // namespace lambent::frame
