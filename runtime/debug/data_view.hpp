// Draws the surfaces of a world coloured by numbers of their coded transfer instead of their light, or their
// triangles as wires over the picture. It takes what is resident and the view, and draws into the bound
// framebuffer: false colours that are shown as they are (ToneMapper::run with as_is), or in linear pictures
// the numbers themselves. Each draw is issued by itself, since these pictures need not be fast. A DataView
// exists only while a view asks for it. Render thread only. Fails if a shader does not compile on this
// device.
#pragma once

#include <cstdint>
#include <optional>

#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/draws/surface_record.hpp"
#include "runtime/ecs/registry.hpp"
#include "runtime/evaluate/transfer_values.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/surface/views.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

class Surfaces;

class DataView {
 public:
  // If `numbers` is set, pictures hold the numbers themselves, and textures are read at their full
  // resolution.
  explicit DataView(bool numbers);

  // Computes the numbers that are not known yet.
  Result<void> update(World& world, const lighting::GroupLights& lights, const ViewChoice& choice,
                      evaluate::TransferMode mode, gpu::Counters& counters);
  // Draws colours and depth for a view of transfer. Blended surfaces are drawn as opaque ones.
  Result<void> draw(World& world, const spec::View& view, gpu::Counters& counters);
  // Draws wires over what is there; colours are premultiplied by alpha.
  Result<void> drawWires(World& world, const spec::View& view, gpu::Counters& counters);

  // Writes the number of the draw that is visible at each pixel, with its normal, to a target of four
  // integers. Draws are those that `surfaces` shows.
  Result<void> drawPicked(World& world, const spec::View& view, const Surfaces& surfaces);

  // Returns the legend of the last update().
  const ViewLegend& legend() const { return legend_; }
  const evaluate::TransferValues& values() const { return values_; }

 private:
  enum class Kind : std::uint8_t { Values, Clusters, Wires, Picked };
  Result<void> drawAll(World& world, const spec::View& view, Kind kind, gpu::Counters& counters,
                       const Surfaces* shown = nullptr);

  bool numbers_;
  gpu::Programs programs_;
  evaluate::TransferValues values_;
  gpu::Table draws_, view_;
  gpu::VertexArray no_vertices_;
  TextureUnits units_;
  ViewChoice choice_;
  ViewLegend legend_;
};

struct Picked {
  ecs::Entity draw;  // null: a volume
  ecs::Entity node;  // of the draw, or that which the volume's group moves with
  ecs::Entity group;
  ecs::Entity material;  // null: a volume, or a draw without a material
  glm::vec3 position_ws{0.0f};
  glm::vec3 normal_ws{0.0f};  // on the visible side, interpolated; for a volume towards the eye
};

// Describes a point of a picture, and what counts there.
struct PickPoint {
  spec::Size size;             // of the picture
  float x = 0.0f, y = 0.0f;    // in pixels from its top left corner
  bool finest_texels = false;  // as in the surface pass
  bool volumes = true;
};

// Finds what is visible at a point of the picture. It takes the world, what the surface pass shows of it, the
// view and a point, and returns the draw there with its node, group, position and normal, or the volume whose
// box the ray meets first, or nothing for the sky. It draws surfaces into that single pixel, with cut-outs
// and culling as in the picture, so it picks what is seen; blended surfaces count where they are visible at
// all. A volume counts if the ray enters its box before any surface, or starts inside and meets no surface.
// It holds one pixel, and nothing before the first use. Render thread only; it waits for the GPU. Fails if a
// shader does not compile on this device.
class Picker {
 public:
  Result<std::optional<Picked>> pick(World& world, const Surfaces& surfaces, const spec::View& view,
                                     const PickPoint& point);

 private:
  struct Seen {
    std::uint32_t draw = 0;
    glm::vec3 normal_group{0.0f};
    float depth = 1.0f;  // window depth, 0..1
  };
  // The view must scale the one pixel to fill clip space.
  Result<std::optional<Seen>> drawPixel(World& world, const Surfaces& surfaces, const spec::View& pixel,
                                        bool finest_texels);

  gpu::Texture seen_, depth_;
  gpu::Framebuffer target_;
  std::optional<DataView> draws_;
};

}  // namespace lambent::frame
