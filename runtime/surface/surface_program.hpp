// Puts together the program of a kind of surface: a receiver (surface.frag), and the modules that add light
// to it.
#pragma once

#include <compare>
#include <cstdint>
#include <span>

#include "runtime/base/result.hpp"
#include "runtime/draws/glossy_record.hpp"
#include "runtime/draws/surface_module.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/surface/views.hpp"

namespace lambent::frame {

// The tables of GLSL text that programs of this room include files from.
extern const gpu::FindText kSurfaceShaders[6];

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

}  // namespace lambent::frame
