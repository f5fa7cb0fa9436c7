// Draws every resident, shaded primitive: opaque and masked ones in as few multi-draws as textures, pages and
// culling allow, blended ones afterwards from back to front. Reads the arenas; writes the bound framebuffer.
// Back faces of single-sided materials are culled, as glTF asks; mirrored nodes turn their winding. Errors:
// shaders that do not compile on this device.
#pragma once

#include <array>
#include <compare>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/effects/diffuse/diffuse.hpp"
#include "runtime/frame/surface_record.hpp"
#include "runtime/frame/surface_shared.h"
#include "runtime/frame/texture_units.hpp"
#include "runtime/frame/world.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/spec/camera.hpp"

namespace lambent::frame {

class Surfaces {
 public:
  // finest_texels: textures at their full resolution, for pictures of one ray per pixel.
  static Result<Surfaces> create(bool finest_texels);

  // Brings draw records and commands up to date.
  void prepare(World& world, const effects::diffuse::Diffuse& diffuse, const spec::View& view,
               gpu::Counters& counters);
  void drawOpaque(World& world, gpu::Counters& counters);
  void drawBlended(World& world, gpu::Counters& counters);

 private:
  struct Command {  // as glMultiDrawElementsIndirect reads it
    std::uint32_t count, instance_count, first_index, base_vertex, base_instance;
  };
  // Draws that may go into one multi-draw.
  struct State {
    std::uint32_t geometry_page = 0, radiance_page = 0;
    SurfaceTextures textures;
    bool normal_mapped = false;
    bool clockwise = false;  // which winding is seen
    auto operator<=>(const State&) const = default;
  };
  struct Run {
    State state;
    std::uint32_t first_command = 0, command_count = 0;
  };
  struct Item {
    State state;
    std::uint32_t draw = 0;
    float distance = 0.0f;
  };

  Surfaces();
  void collect(World& world, const effects::diffuse::Diffuse& diffuse, glm::vec3 eye_ws,
               std::vector<Item>& opaque, std::vector<Item>& blended);
  void appendRuns(const World& world, const std::vector<Item>& items, std::vector<Run>& runs,
                  std::vector<Command>& commands) const;
  void drawRuns(World& world, const std::vector<Run>& runs, gpu::Counters& counters);

  std::array<gpu::Program, 2> programs_;  // light as radiance, light for normal maps
  TextureUnits units_;
  gpu::VertexArray vertices_;
  gpu::Buffer draw_indices_;
  gpu::Table draws_, commands_, view_;
  std::vector<SurfaceDraw> records_;
  std::vector<Run> opaque_, blended_;
  std::uint64_t residency_seen_ = 0, transforms_seen_ = 0, lamps_seen_ = 0;
  std::size_t shaded_seen_ = 0;
  glm::vec3 eye_seen_ws_{0.0f};
};

}  // namespace lambent::frame
