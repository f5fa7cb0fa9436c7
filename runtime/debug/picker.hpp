// What stands at a point of the picture. Comes in: the world, what of it the surface pass shows, the view, a
// point. Goes out: the draw that is seen there, with its node, group, place and normal, or the volume whose
// box the ray meets first; none: the sky. Surfaces are found by drawing that one pixel, with cut-outs and
// culling as in the picture, so what is picked is what is seen; blended surfaces count where they can be seen
// at all. A volume counts where the ray enters its box before any surface, or where it starts within and
// meets none. On demand only: holds a pixel, and nothing before the first time. Render thread; waits for the
// GPU. Errors: a shader that does not compile on this device.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/draws/draw_indices.hpp"
#include "runtime/draws/surface_record.hpp"
#include "runtime/draws/texture_units.hpp"
#include "runtime/ecs/entity.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/size.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

class Surfaces;

struct Picked {
  ecs::Entity draw;  // none: a volume
  ecs::Entity node;  // of the draw, or what the volume's group moves with
  ecs::Entity group;
  ecs::Entity material;  // none: a volume, or a draw without one
  glm::vec3 position_ws{0.0f};
  glm::vec3 normal_ws{0.0f};  // of the vertices, of the side that is seen; of a volume towards the eye
};

struct PickOptions {
  bool finest_texels = false;  // as the surface pass has it
  bool volumes = true;
};

class Picker {
 public:
  Picker();

  // x, y in pixels from the top left corner of a picture of this size.
  Result<std::optional<Picked>> pick(World& world, const Surfaces& surfaces, const spec::View& view,
                                     const spec::Size& size, float x, float y, const PickOptions& options);

 private:
  struct Seen {
    std::uint32_t draw = 0;
    glm::vec3 normal_group{0.0f};
    float depth = 1.0f;  // of the window, 0..1
  };
  Result<void> compile(const PickOptions& options);
  // clip_from_world: the one pixel fills clip space.
  std::optional<Seen> drawPixel(World& world, const Surfaces& surfaces, const glm::mat4& clip_from_world);

  std::optional<gpu::Program> program_;
  gpu::Texture seen_, depth_;
  gpu::Framebuffer target_;
  gpu::Table draws_, commands_;
  DrawIndices indices_;
  std::optional<TextureUnits> units_;
};

}  // namespace lambent::frame
