// Owns the shadow casters: all resident opaque and masked draws of a world, both sides of each. It draws them
// into tiles of a depth texture, for the shadow cubes of local lights and the shadow maps of key lights.
// Render thread only.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
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
  // Both shaders are compiled for opaque casters and for masked ones.
  ShadowCasters(std::string_view label, std::string_view vertex, std::string_view fragment)
      : label_(label),
        vertex_(vertex),
        fragment_(fragment),
        records_(label),
        commands_(label),
        views_(label),
        indices_(label) {}
  // Does nothing if it was called before. Fails if a shader does not compile on this device.
  Result<void> compile();

  // Gathers the casters again if the world changed since the last call, and returns whether it did.
  bool follow(const World& world);
  const std::vector<ShadowCaster>& all() const { return casters_; }

  // Makes an empty texture of this size in texels.
  void resize(std::uint32_t width, std::uint32_t height);
  const gpu::Texture& depths() const { return depths_; }

  // Describes a square of the texture, and the casters drawn into it.
  struct Tile {
    std::uint32_t x = 0, y = 0, size = 0;  // in texels
    // Its uniform block; OpenGL 4.5 asks for no larger alignment of these.
    std::array<std::byte, 256> view{};
    std::vector<const ShadowCaster*> casters;

    template <typename View>
    void setView(const View& block) {
      static_assert(sizeof(View) <= sizeof(view));
      std::memcpy(view.data(), &block, sizeof(View));
    }
  };
  // Clears the tiles to 1 and draws them, with their uniform blocks at this binding. Changes the bound
  // framebuffer, viewport, scissor, depth and culling state.
  void draw(World& world, std::span<const Tile> tiles, GLuint binding, gpu::Counters& counters);

 private:
  std::string_view label_, vertex_, fragment_;  // refer to literals
  std::array<gpu::Program, 2> programs_;        // for opaque casters and for masked ones
  gpu::Texture depths_;
  gpu::Handle<gpu::FramebufferTraits> target_;
  std::vector<ShadowCaster> casters_;
  gpu::Table records_, commands_, views_;
  DrawIndices indices_;
  TextureUnits units_;
  ChangeGate<std::uint64_t, std::uint64_t, std::uint64_t> changed_;  // residency, transforms, materials
};

}  // namespace lambent::frame
