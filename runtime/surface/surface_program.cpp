#include "runtime/surface/surface_program.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "lambent_draws_embedded.hpp"
#include "lambent_effects_neighborhood_embedded.hpp"
#include "lambent_lighting_embedded.hpp"
#include "lambent_shadows_embedded.hpp"
#include "lambent_surface_embedded.hpp"
#include "lambent_transfer_embedded.hpp"
#include "runtime/transfer/seen_sky_shared.h"

namespace lambent::frame {

const gpu::FindText kSurfaceShaders[6] = {
    &embedded::lambent_surface::find,  &embedded::lambent_draws::find,
    &embedded::lambent_transfer::find, &embedded::lambent_lighting::find,
    &embedded::lambent_shadows::find,  &embedded::lambent_effects_neighborhood::find};

namespace {

std::string_view vertexFileOf(SurfaceReceiver receiver) {
  if (isGlossy(receiver)) return "glossy_vertex.glsl";
  const bool mapped = receiver == SurfaceReceiver::NormalMapped || receiver == SurfaceReceiver::LayeredMapped;
  return mapped ? "normal_mapped_vertex.glsl" : "diffuse_vertex.glsl";
}

std::string_view fileOf(SurfaceReceiver receiver) {
  switch (receiver) {
    case SurfaceReceiver::Diffuse:
      return "diffuse_receiver.glsl";
    case SurfaceReceiver::NormalMapped:
      return "normal_mapped_receiver.glsl";
    case SurfaceReceiver::Layered:
      return "layered_receiver.glsl";
    case SurfaceReceiver::LayeredMapped:
      return "layered_mapped_receiver.glsl";
    case SurfaceReceiver::Ggx:
      return "ggx_receiver.glsl";
    case SurfaceReceiver::Measured:
      break;
  }
  return "measured_receiver.glsl";
}

int shownBy(SurfaceView view) {
  return view == SurfaceView::Irradiance ? 1 : view == SurfaceView::Normals ? 2 : 0;
}

std::string kindText(const SurfaceKind& kind, bool finest_texels) {
  return fmt::format(
      "const bool kFinestTexels = {};\n"
      "const bool kDark = {};\n"
      "const bool kHasTexels = {};\n"
      "const int kShownRadiance = 0, kShownIrradiance = 1, kShownNormals = 2;\n"
      "const int kShown = {};\n",
      finest_texels, kind.dark, kind.texels, shownBy(kind.view));
}

// Describes a function whose body calls each module's function in turn.
struct Caller {
  SurfaceHook hook;
  const char* file;
  const char* signature;
  const char* arguments;
};

Caller vertexCaller(SurfaceReceiver receiver) {
  return {SurfaceHook::Vertex, "vertex_light.glsl",
          receiver == SurfaceReceiver::NormalMapped || receiver == SurfaceReceiver::LayeredMapped
              ? "addVertexLight(uint vertex, inout vec3 light[kLightCoefficients])"
              : "addVertexLight(uint vertex, inout vec3 light)",
          "vertex, light"};
}

Caller mirrorCaller(SurfaceReceiver receiver) {
  if (isLayered(receiver))
    return {SurfaceHook::MirroredSky, "mirrored_sky.glsl",
            "addMirroredSky(Mirror mirror, SurfaceLight light, inout vec3 mirrored, inout vec3 highlights)",
            "mirror, light, mirrored, highlights"};
  return {
      SurfaceHook::MirroredSky, "mirrored_sky.glsl",
      "addMirroredSky(Reflected reflected, SurfaceLight light, inout vec3 mirrored, inout vec3 highlights)",
      "reflected, light, mirrored, highlights"};
}

constexpr Caller kPixelCallers[] = {
    {SurfaceHook::Gathered, "gathered_light.glsl",
     "addGatheredLight(uvec3 corners, vec3 weights, inout vec4 light[kCoefficients])",
     "corners, weights, light"},
    {SurfaceHook::Received, "received_light.glsl", "receiveLight(SurfacePoint at, inout SurfaceLight light)",
     "at, light"},
};

gpu::WrittenFile callerFile(const Caller& caller, std::span<const SurfaceFunction> functions) {
  std::string includes, body;
  for (const SurfaceFunction& function : functions) {
    if (function.hook != caller.hook) continue;
    includes += fmt::format("#include \"{}\"\n", function.file);
    body += fmt::format("  {}({});\n", function.name, caller.arguments);
  }
  return {caller.file, fmt::format("{}void {} {{\n{}}}\n", includes, caller.signature, body)};
}

}  // namespace

SurfaceReceiver SurfaceKind::receiver() const {
  if (layered) return normal_mapped ? SurfaceReceiver::LayeredMapped : SurfaceReceiver::Layered;
  if (glossy.bands > 0)
    return glossy.family == bundle::BrdfFamily::Measured ? SurfaceReceiver::Measured : SurfaceReceiver::Ggx;
  return normal_mapped ? SurfaceReceiver::NormalMapped : SurfaceReceiver::Diffuse;
}

Result<gpu::Program> makeSurfaceProgram(const SurfaceKind& kind,
                                        std::span<const SurfaceModule* const> modules, bool finest_texels) {
  const SurfaceReceiver receiver = kind.receiver();
  std::vector<SurfaceFunction> functions;
  std::vector<gpu::FindText> tables(std::begin(kSurfaceShaders), std::end(kSurfaceShaders));
  for (std::size_t m = 0; m < modules.size(); ++m) {
    if ((kind.modules & bitOf(m)) == 0) continue;
    std::ranges::copy_if(modules[m]->functions(), std::back_inserter(functions),
                         [&](const SurfaceFunction& function) { return calls(receiver, function.by); });
    tables.insert(tables.end(), modules[m]->shaders().begin(), modules[m]->shaders().end());
  }
  std::vector<gpu::WrittenFile> written = {
      {"surface_kind.glsl", kindText(kind, finest_texels)},
      {"vertex_receiver.glsl", fmt::format("#include \"{}\"\n", vertexFileOf(receiver))},
      {"receiver.glsl", fmt::format("#include \"{}\"\n", fileOf(receiver))},
      callerFile(vertexCaller(receiver), functions),
      callerFile(mirrorCaller(receiver), functions)};
  for (const Caller& caller : kPixelCallers) written.push_back(callerFile(caller, functions));
  std::vector<gpu::Define> defines;
  if (kind.glossy.bands > 0) defines = definesOf(kind.glossy);
  if (kind.layered) {
    defines.push_back({"LAMBENT_LAYERED", "1"});
    defines.push_back({"LAMBENT_SEEN_AXES", axesText(sh::ZonalFactors(static_cast<int>(transfer::kSeenBands),
                                                                      /*isotropic=*/true))});
  }
  return gpu::Program::create("surface",
                              {{GL_VERTEX_SHADER, "surface.vert"}, {GL_FRAGMENT_SHADER, "surface.frag"}},
                              {.tables = tables, .defines = defines, .written = written});
}

}  // namespace lambent::frame
