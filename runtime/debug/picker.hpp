// Finds what is visible at a point of the picture. It takes the world, what the surface pass shows of it, the
// view and a point, and returns the draw there with its node, group, position and normal, or the volume whose
// box the ray meets first, or nothing for the sky. It draws surfaces into that single pixel, with cut-outs
// and culling as in the picture, so it picks what is seen; blended surfaces count where they are visible at
// all. A volume counts if the ray enters its box before any surface, or starts inside and meets no surface.
// It holds one pixel, and nothing before the first use. Render thread only; it waits for the GPU. Fails if a
// shader does not compile on this device.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/draws/surface_record.hpp"
#include "runtime/ecs/registry.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

class Surfaces;

struct Picked {
  ecs::Entity draw;  // null: a volume
  ecs::Entity node;  // of the draw, or that which the volume's group moves with
  ecs::Entity group;
  ecs::Entity material;  // null: a volume, or a draw without a material
  glm::vec3 position_ws{0.0f};
  glm::vec3 normal_ws{0.0f};  // on the visible side, interpolated; for a volume towards the eye
};

// Describes a point of a picture of this size, in pixels from its top left corner.
struct PicturePoint {
  spec::Size size;
  float x = 0.0f, y = 0.0f;
};

struct PickOptions {
  bool finest_texels = false;  // as in the surface pass
  bool volumes = true;
};

class Picker {
 public:
  Picker();

  Result<std::optional<Picked>> pick(World& world, const Surfaces& surfaces, const spec::View& view,
                                     const PicturePoint& point, const PickOptions& options);

 private:
  struct Seen {
    std::uint32_t draw = 0;
    glm::vec3 normal_group{0.0f};
    float depth = 1.0f;  // window depth, 0..1
  };
  Result<void> compile(const PickOptions& options);
  // clip_from_world must scale the one pixel to fill clip space.
  std::optional<Seen> drawPixel(World& world, const Surfaces& surfaces, const glm::mat4& clip_from_world);

  std::optional<gpu::Program> program_;
  gpu::Texture seen_, depth_;
  gpu::Framebuffer target_;
  gpu::Table draws_, commands_;
  DrawIndices indices_;
  std::optional<TextureUnits> units_;
};

}  // namespace lambent::frame
