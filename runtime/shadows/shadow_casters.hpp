// What stops light: all resident opaque and masked draws of a world, both sides of each, and how they are
// drawn into tiles of a depth texture. Shadow cubes of local lights and shadow maps of key lights are made of
// them. Render thread only; no errors of its own.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <glm/mat4x4.hpp>

#include "runtime/draws/draw_indices.hpp"
#include "runtime/draws/surface_record.hpp"
#include "runtime/draws/texture_units.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// The same casters make the same shadows.
struct ShadowCaster {
  std::uint32_t draw = 0;
  std::uint64_t id = 0;  // of the draw
  glm::mat4 world_from_mesh{1.0f};
  scene::Box bounds_ws;
  gpu::Allocation block;
  bool masked = false;
  std::uint32_t image_levels = 0;           // that have arrived
  float alpha = 1.0f, alpha_cutoff = 0.0f;  // of masked ones
  bool operator==(const ShadowCaster& other) const;
};

class ShadowCasters {
 public:
  explicit ShadowCasters(std::string_view label);

  // Looks again where the world is other than at the last call; whether it was.
  bool follow(const World& world);
  const std::vector<ShadowCaster>& all() const { return casters_; }

  // A square of the texture, and what is drawn into it.
  struct Tile {
    std::uint32_t x = 0, y = 0, size = 0;  // texels
    std::size_t view = 0;                  // where its uniform block begins in the buffer of views, bytes
    std::vector<const ShadowCaster*> casters;
  };
  // For opaque casters and for masked ones.
  using Programs = std::array<gpu::Program, 2>;
  // Clears the tiles of the bound framebuffer's depth to 1 and draws them. views: uniform blocks of
  // view_bytes, bound to view_binding tile by tile. Changes viewport, scissor, depth and culling state.
  void draw(World& world, std::span<const Tile> tiles, const Programs& programs, const gpu::Buffer& views,
            std::size_t view_bytes, GLuint view_binding, gpu::Counters& counters);

 private:
  // Casters that may go into one multi-draw.
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
  std::uint64_t residency_seen_ = 0, transforms_seen_ = 0, materials_seen_ = 0;
  bool seen_ = false;
};

}  // namespace lambent::frame
