// Draws every primitive that is resident and shaded: opaque and masked ones in as few multi-draws as
// textures, pages and culling allow, then blended ones and panes from back to front. Draws that the view does
// not reach are left out. It reads the arenas and writes the bound framebuffer. Back faces of single-sided
// materials are culled, as glTF asks; mirrored nodes reverse their winding. Each kind of surface (glossy
// ones, and those that modules reach) has a program of its own, compiled when the first such draw arrives.
// Glossy surfaces are shaded here entirely, per pixel. Only the records and commands that changed are
// uploaded. Fails if a shader does not compile on this device.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/draws/surface_module.hpp"
#include "runtime/draws/surface_record.hpp"
#include "runtime/draws/surface_shared.h"
#include "runtime/effects/diffuse/diffuse.hpp"
#include "runtime/evaluate/seen_sky.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/surface/views.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// The tables of GLSL text that programs of this room include files from.
extern const gpu::FindText kSurfaceShaders[7];

// Names a kind of surface. Its program consists of a receiver (surface.frag) and the modules that add light
// to it.
struct SurfaceKind {
  bool normal_mapped = false;
  bool dark = false;          // reflects nothing
  std::uint32_t modules = 0;  // a bit for each module, see bitOf()
  bool texels = false;        // takes E/pi from a texture
  bool layered = false;       // a specular layer over diffuse or normal-mapped transfer
  GlossyKind glossy = {};
  SurfaceView view = SurfaceView::Final;  // Final, Irradiance or Normals
  auto operator<=>(const SurfaceKind&) const = default;

  SurfaceReceiver receiver() const;
};

// Returns the bit of the module at this place of the list.
constexpr std::uint32_t bitOf(std::size_t module) {
  return 0x80000000u >> module;
}

// Compiles and links the program. If finest_texels is set, textures are read at their full resolution, for
// pictures with one ray per pixel. Fails if a shader does not compile on this device.
Result<gpu::Program> makeSurfaceProgram(const SurfaceKind& kind,
                                        std::span<const SurfaceModule* const> modules, bool finest_texels);

struct SurfaceOptions {
  bool diffuse = true, glossy = true;  // false: such surfaces reflect nothing
  std::uint32_t glossy_bands = 8;      // largest number of bands that glossy surfaces reflect
  // Irradiance and Normals have programs of their own, compiled when they are first asked for; all other
  // views are drawn as Final.
  SurfaceView view = SurfaceView::Final;
  bool operator==(const SurfaceOptions&) const = default;
};

class Surfaces {
 public:
  // If finest_texels is set, textures are read at their full resolution, for pictures with one ray per pixel.
  // The modules must outlive the surfaces and stay the same.
  Surfaces(bool finest_texels, const SurfaceModules& modules);

  // Updates draw records and commands. What vertices see of the sky must live until surfaces are drawn.
  Result<void> prepare(World& world, const effects::diffuse::Diffuse& diffuse,
                       const evaluate::SeenSky& seen_sky, const spec::View& view,
                       const SurfaceOptions& options, gpu::Counters& counters);
  // Returns how many draws the last prepare() left out because the view does not reach them.
  std::uint32_t countOutOfView() const { return out_of_view_; }
  // Returns whether the last prepare() has the draw in the picture, if the view reaches it.
  bool shows(std::size_t draw) const { return draw < shown_.size() && shown_[draw] != 0; }
  void drawOpaque(World& world, gpu::Counters& counters);
  void drawBlended(World& world, gpu::Counters& counters);

 private:
  // Holds the state that draws must share to go into one multi-draw.
  struct State {
    std::uint32_t geometry_page = 0, radiance_page = 0;
    SurfaceTextures textures = {};
    SurfaceKind kind = {};
    // These are used by glossy draws only, the bundle and the table by layered ones too.
    std::uint32_t bundle = 0, rows_page = 0, samples_page = 0;
    std::int32_t brdf_table = -1;
    std::int32_t irradiance = -1;  // draw whose texels it shows; -1: none
    bool clockwise = false;        // winding of the visible side
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
  using Items = std::vector<Item>;

  bool dark(const World& world, std::size_t draw) const;
  bool ready(const World& world, const effects::diffuse::Diffuse& diffuse, std::size_t draw) const;
  bool layered(const World& world, std::size_t draw) const;
  SurfaceKind kindOf(const World& world, std::size_t draw) const;
  // Describes all draws that are ready, and puts them in order.
  Result<void> collect(World& world, const effects::diffuse::Diffuse& diffuse, glm::vec3 eye_ws,
                       gpu::Counters& counters);
  // Finds which draws the view may reach. Returns whether these are others than before.
  bool lookAt(const World& world, const spec::View& view);
  void appendRuns(const World& world, const Items& items, std::vector<Run>& runs,
                  std::vector<DrawCommand>& commands) const;
  Result<void> compile(const SurfaceKind& kind);
  void drawRuns(World& world, const std::vector<Run>& runs, gpu::Counters& counters);

  bool finest_texels_;
  std::map<SurfaceKind, gpu::Program> programs_;  // compiled when they are first needed
  TextureUnits units_;
  DrawIndices indices_;
  gpu::Table draws_, glossy_draws_, commands_, view_;
  std::vector<SurfaceDraw> records_;
  std::vector<GlossyDraw> glossy_records_;
  std::vector<std::uint8_t> shown_, in_view_;  // indexed by draw
  std::uint32_t out_of_view_ = 0;
  Items opaque_items_, blended_items_;
  std::vector<scene::Box> bounds_ws_;  // indexed by draw; empty: not known, so it is in view
  ChangeGate<std::uint64_t, std::uint64_t> bounds_from_;  // residency and transforms
  SurfaceOptions options_;
  const evaluate::SeenSky* seen_sky_ = nullptr;  // of the last prepare()
  std::vector<std::uint32_t> glossy_index_;      // index of each draw in glossy_records_
  std::vector<Run> opaque_, blended_;
  const SurfaceModules& modules_;
  std::vector<std::uint64_t> seen_;  // versions of all that records and commands depend on
  glm::vec3 eye_seen_ws_{0.0f};
};

}  // namespace lambent::frame
