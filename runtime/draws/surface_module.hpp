// Defines modules, which add light to surfaces in the raster pass. For some points of the surfaces' programs
// a module has a GLSL function, in a file of kSurfaceShaders. Surfaces asks each module which
// draws it reaches, and puts a program together for every set of modules that some draw has
// (makeSurfaceProgram). The functions have these forms:
//   Vertex       void f(uint vertex, inout vec3 radiance), for normal-mapped draws
//                void f(uint vertex, inout vec3 light[kLightCoefficients])
//   Gathered     void f(uvec3 corners, vec3 weights, inout vec4 light[kCoefficients])
//   Received     void f(SurfacePoint at, inout SurfaceLight light), see surface_light.glsl
//   MirroredSky  void f(Reflected reflected, SurfaceLight light, inout vec3 mirrored, inout vec3 highlights),
//   for
//                layered draws void f(Mirror mirror, ...), see layer.glsl; it changes what the mirror shows,
//                and highlights of key lights. Functions are called in the order of the list of modules
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "runtime/draws/surface_shared.h"

namespace lambent::frame {

enum class SurfaceHook : std::uint8_t { Vertex, Gathered, Received, MirroredSky };

// Tells how a surface uses the light that transfer brings to it.
enum class SurfaceReceiver : std::uint8_t { Diffuse, NormalMapped, Layered, LayeredMapped, Ggx, Measured };
constexpr bool isGlossy(SurfaceReceiver receiver) {
  return receiver == SurfaceReceiver::Ggx || receiver == SurfaceReceiver::Measured;
}
constexpr bool isNormalMapped(SurfaceReceiver receiver) {
  return receiver == SurfaceReceiver::NormalMapped || receiver == SurfaceReceiver::LayeredMapped;
}
// Returns whether a specular layer lies over its diffuse transfer.
constexpr bool isLayered(SurfaceReceiver receiver) {
  return receiver == SurfaceReceiver::Layered || receiver == SurfaceReceiver::LayeredMapped;
}

// Tells which receivers call a function.
enum class CalledBy : std::uint8_t {
  All,
  Diffuse /* also with normal maps and layers */,
  Layered,
  Glossy,
  Ggx
};
constexpr bool calls(SurfaceReceiver receiver, CalledBy by) {
  return by == CalledBy::All || (by == CalledBy::Ggx && receiver == SurfaceReceiver::Ggx) ||
         (by == CalledBy::Layered && isLayered(receiver)) || (by == CalledBy::Glossy && isGlossy(receiver)) ||
         (by == CalledBy::Diffuse && !isGlossy(receiver));
}

struct SurfaceFunction {
  SurfaceHook hook;
  CalledBy by;
  std::string_view file, name;
};

class SurfaceModule {
 public:
  explicit SurfaceModule(std::span<const SurfaceFunction> functions) : functions_(functions) {}
  virtual ~SurfaceModule() = default;

  std::span<const SurfaceFunction> functions() const { return functions_; }
  // Returns whether the draw has light of this module; `record` is complete but for what modules describe.
  virtual bool reaches(std::size_t draw, const SurfaceDraw& record) const = 0;
  // Changes when the answer of reaches() or describe() changes for any draw.
  virtual std::uint64_t version() const = 0;
  // Writes what the module's functions read of the draw's record.
  virtual void describe(std::size_t, SurfaceDraw&) const {}
  // Binds what the functions read, before draws with such a receiver are drawn.
  virtual void bindFor(SurfaceReceiver) const {}

 private:
  std::span<const SurfaceFunction> functions_;
};

// Lists the modules of a frame.
using SurfaceModules = std::vector<const SurfaceModule*>;

}  // namespace lambent::frame
