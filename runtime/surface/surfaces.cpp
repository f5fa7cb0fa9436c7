#include "runtime/surface/surfaces.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "lambent_bounces_embedded.hpp"
#include "lambent_draws_embedded.hpp"
#include "lambent_effects_neighborhood_embedded.hpp"
#include "lambent_lighting_embedded.hpp"
#include "lambent_shadows_embedded.hpp"
#include "lambent_surface_embedded.hpp"
#include "lambent_transfer_embedded.hpp"
#include "runtime/draws/surface_record.hpp"
#include "runtime/transfer/seen_sky_shared.h"

namespace lambent::frame {

const gpu::FindText kSurfaceShaders[7] = {&embedded::lambent_surface::find,
                                          &embedded::lambent_draws::find,
                                          &embedded::lambent_transfer::find,
                                          &embedded::lambent_lighting::find,
                                          &embedded::lambent_shadows::find,
                                          &embedded::lambent_bounces::find,
                                          &embedded::lambent_effects_neighborhood::find};

namespace {

std::string_view fileOf(SurfaceReceiver receiver) {
  if (isGlossy(receiver)) return "glossy_receiver.glsl";
  return isNormalMapped(receiver) ? "normal_mapped_receiver.glsl" : "diffuse_receiver.glsl";
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

std::array<Caller, 4> callersOf(SurfaceReceiver receiver) {
  const bool layered = isLayered(receiver);
  return {
      {{SurfaceHook::Vertex, "vertex_light.glsl",
        isNormalMapped(receiver) ? "addVertexLight(uint vertex, inout vec3 light[kLightCoefficients])"
                                 : "addVertexLight(uint vertex, inout vec3 light)",
        "vertex, light"},
       {SurfaceHook::MirroredSky, "mirrored_sky.glsl",
        layered
            ? "addMirroredSky(Mirror mirror, SurfaceLight light, inout vec3 mirrored, inout vec3 highlights)"
            : "addMirroredSky(Reflected mirror, SurfaceLight light, inout vec3 mirrored, inout vec3 "
              "highlights)",
        "mirror, light, mirrored, highlights"},
       {SurfaceHook::Gathered, "gathered_light.glsl",
        "addGatheredLight(uvec3 corners, vec3 weights, inout vec4 light[kCoefficients])",
        "corners, weights, light"},
       {SurfaceHook::Received, "received_light.glsl",
        "receiveLight(SurfacePoint at, inout SurfaceLight light)", "at, light"}}};
}

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
  for (std::size_t m = 0; m < modules.size(); ++m) {
    if ((kind.modules & bitOf(m)) == 0) continue;
    std::ranges::copy_if(modules[m]->functions(), std::back_inserter(functions),
                         [&](const SurfaceFunction& function) { return calls(receiver, function.by); });
  }
  std::vector<gpu::WrittenFile> written = {
      {"surface_kind.glsl", kindText(kind, finest_texels)},
      {"receiver.glsl", fmt::format("#include \"{}\"\n", fileOf(receiver))}};
  for (const Caller& caller : callersOf(receiver)) written.push_back(callerFile(caller, functions));
  std::vector<gpu::Define> defines;
  if (kind.glossy.bands > 0) defines = definesOf(kind.glossy);
  if (isNormalMapped(receiver)) defines.push_back({"LAMBENT_NORMAL_MAPPED", "1"});
  if (kind.layered) {
    defines.push_back({"LAMBENT_LAYERED", "1"});
    defines.push_back({"LAMBENT_SEEN_AXES", axesText(sh::ZonalFactors(static_cast<int>(transfer::kSeenBands),
                                                                      /*isotropic=*/true))});
  }
  return gpu::Program::create("surface",
                              {{GL_VERTEX_SHADER, "surface.vert"}, {GL_FRAGMENT_SHADER, "surface.frag"}},
                              {.tables = kSurfaceShaders, .defines = defines, .written = written});
}

namespace {

glm::vec4 eyeOf(const spec::View& view) {
  const bool perspective = view.clip_from_view[2][3] != 0.0f;
  if (perspective) return {view.eye_ws, 1.0f};
  const glm::mat4& from_world = view.view_from_world;
  return {from_world[0][2], from_world[1][2], from_world[2][2], 0.0f};
}

}  // namespace

Surfaces::Surfaces(bool finest_texels, const SurfaceModules& modules)
    : finest_texels_(finest_texels),
      indices_("surface"),
      draws_("surface draws"),
      glossy_draws_("glossy draws"),
      commands_("surface commands"),
      view_("view"),
      modules_(modules) {}

Result<void> Surfaces::compile(const SurfaceKind& kind) {
  if (programs_.contains(kind)) return {};
  Result<gpu::Program> program = makeSurfaceProgram(kind, modules_, finest_texels_);
  if (!program) return failAgain(program.error());
  programs_.emplace(kind, std::move(*program));
  return {};
}

bool Surfaces::dark(const World& world, std::size_t draw) const {
  return !(world.residency().draws()[draw].glossy() ? options_.glossy : options_.diffuse);
}

bool Surfaces::ready(const World& world, const effects::diffuse::Diffuse& diffuse, std::size_t draw) const {
  if (!world.showsSurfaces(world.residency().draws()[draw].bundle)) return false;  // a proxy stands in for it
  if (dark(world, draw)) return bool(world.residency().meshes()[world.residency().draws()[draw].mesh].block);
  return world.residency().draws()[draw].glossy() ? glossyReady(world, draw) : diffuse.shaded(draw);
}

// Until what its vertices see is known, a layered draw is shown without its layer.
bool Surfaces::layered(const World& world, std::size_t draw) const {
  return options_.glossy && seen_sky_->known(draw) && layerReady(world, draw);
}

SurfaceKind Surfaces::kindOf(const World& world, std::size_t draw) const {
  const bool other = options_.view == SurfaceView::Irradiance || options_.view == SurfaceView::Normals;
  SurfaceKind kind{.view = other ? options_.view : SurfaceView::Final};
  if (dark(world, draw)) {
    kind.dark = true;
    return kind;
  }
  kind.normal_mapped = normalMapped(world, draw);
  if (world.residency().draws()[draw].glossy())
    kind.glossy = glossyKindOf(world, draw, options_.glossy_bands);
  kind.layered = layered(world, draw);
  kind.texels = hasTexels(world, draw);
  if (kind.layered) kind.glossy = layerKindOf(world, draw);
  const SurfaceReceiver receiver = kind.receiver();
  for (std::size_t m = 0; m < modules_.size(); ++m)
    if (modules_[m]->reaches(draw, records_[draw]) &&
        std::ranges::any_of(modules_[m]->functions(),
                            [&](const SurfaceFunction& f) { return calls(receiver, f.by); }))
      kind.modules |= bitOf(m);
  return kind;
}

bool Surfaces::lookAt(const World& world, const spec::View& view) {
  const auto& draws = world.residency().draws();
  if (bounds_from_.renew(world.residency().version(), world.transformsVersion())) {
    bounds_ws_.clear();
    for (const streaming::ResidentDraw& draw : draws)
      bounds_ws_.push_back(
          scene::drawBounds(world.registry(), world.instance(draw.bundle).draws[draw.index]));
  }
  const glm::mat4 clip_from_world = view.clip_from_view * view.view_from_world;
  std::vector<std::uint8_t> in_view(draws.size(), 1);
  out_of_view_ = 0;
  for (std::size_t i = 0; i < draws.size(); ++i) {
    if (bounds_ws_[i].empty() || !outOfView(clip_from_world, bounds_ws_[i])) continue;
    in_view[i] = 0;
    out_of_view_ += shown_[i];
  }
  return std::exchange(in_view_, in_view) != in_view;
}

Result<void> Surfaces::collect(World& world, const effects::diffuse::Diffuse& diffuse, glm::vec3 eye_ws,
                               gpu::Counters& counters) {
  const streaming::Residency& residency = world.residency();
  records_.clear();
  for (std::size_t i = 0; i < residency.draws().size(); ++i) {
    records_.push_back(describe(world, i));
    for (const SurfaceModule* module : modules_) module->describe(i, records_.back());
  }
  glossy_records_.clear();
  glossy_index_.assign(records_.size(), 0);
  opaque_items_.clear();
  blended_items_.clear();
  shown_.assign(residency.draws().size(), 0);
  for (std::uint32_t i = 0; i < residency.draws().size(); ++i) {
    const streaming::ResidentDraw& draw = residency.draws()[i];
    if (!ready(world, diffuse, i)) continue;
    shown_[i] = 1;
    const streaming::ResidentMesh& mesh = residency.meshes()[draw.mesh];
    const glm::mat4& world_from_mesh = records_[i].world_from_mesh;
    Item item{.state = {.geometry_page = mesh.block.page,
                        .radiance_page = draw.radiance.page,
                        .textures = texturesOf(world, i, records_[i]),
                        .kind = kindOf(world, i),
                        .clockwise = (glm::determinant(glm::mat3(world_from_mesh)) < 0.0f) != draw.back},
              .draw = i,
              .distance = glm::distance(eye_ws, glm::vec3(world_from_mesh * glm::vec4(mesh.center, 1.0f)))};
    if (item.state.kind.texels) item.state.irradiance = static_cast<std::int32_t>(i);
    if (item.state.kind.dark) {
      item.state.radiance_page = 0;
    } else if (item.state.kind.glossy.bands > 0) {
      item.state.bundle = draw.bundle;
      item.state.brdf_table = brdfTableOf(world, i);
      if (!item.state.kind.layered) {
        item.state.rows_page = draw.rows.page;
        item.state.samples_page = residency.groups()[draw.group].samples.page;
      }
      glossy_index_[i] = static_cast<std::uint32_t>(glossy_records_.size());
      glossy_records_.push_back({.surface = records_[i], .glossy = describeGlossy(world, i)});
    }
    // What comes into view later must not wait for a compiler.
    if (Result<void> done = compile(item.state.kind); !done) return done;
    const bool through = records_[i].alpha_mode == kAlphaBlend || records_[i].transmission > 0.0f;
    (through ? blended_items_ : opaque_items_).push_back(item);
  }
  std::ranges::stable_sort(opaque_items_, std::ranges::less(), &Item::state);
  std::ranges::stable_sort(blended_items_, std::ranges::greater(), &Item::distance);
  draws_.update(records_, counters);
  glossy_draws_.update(glossy_records_, counters);
  indices_.reserve(records_.size());
  return {};
}

void Surfaces::appendRuns(const World& world, const Items& items, std::vector<Run>& runs,
                          std::vector<DrawCommand>& commands) const {
  for (const Item& item : items) {
    if (in_view_[item.draw] == 0) continue;
    const streaming::ResidentMesh& mesh =
        world.residency().meshes()[world.residency().draws()[item.draw].mesh];
    if (runs.empty() || runs.back().state != item.state)
      runs.push_back({item.state, static_cast<std::uint32_t>(commands.size()), 0});
    ++runs.back().command_count;
    const std::uint32_t record = item.state.kind.glossy.bands > 0 ? glossy_index_[item.draw] : item.draw;
    commands.push_back({mesh.index_count, 1, mesh.indices_word, 0, record});
  }
}

Result<void> Surfaces::prepare(World& world, const effects::diffuse::Diffuse& diffuse,
                               const evaluate::SeenSky& seen_sky, const spec::View& view,
                               const SurfaceOptions& options, gpu::Counters& counters) {
  const bool options_same = std::exchange(options_, options) == options;
  seen_sky_ = &seen_sky;
  view_.assignOne(ViewBlock{view.view_from_world, view.clip_from_view, eyeOf(view)});
  const streaming::Residency& residency = world.residency();
  std::uint64_t shaded = 0;
  for (std::size_t i = 0; i < residency.draws().size(); ++i) shaded += ready(world, diffuse, i) ? 1 : 0;
  std::vector<std::uint64_t> now = {
      residency.version(), world.transformsVersion(), world.lampsVersion(), world.materialsVersion(), shaded,
      seen_sky.version()};
  for (const SurfaceModule* module : modules_) now.push_back(module->version());
  const bool scene_same = options_same && now == seen_;
  const bool same = scene_same && (blended_items_.empty() || view.eye_ws == eye_seen_ws_);
  if (!same) {
    seen_ = std::move(now);
    eye_seen_ws_ = view.eye_ws;
    if (Result<void> done = collect(world, diffuse, view.eye_ws, counters); !done) return done;
  }
  if (!lookAt(world, view) && same) return {};
  std::vector<DrawCommand> commands;
  opaque_.clear();
  blended_.clear();
  appendRuns(world, opaque_items_, opaque_, commands);
  appendRuns(world, blended_items_, blended_, commands);
  commands_.update(commands, counters);
  return {};
}

void Surfaces::drawRuns(World& world, const std::vector<Run>& runs, gpu::Counters& counters) {
  if (runs.empty()) return;
  view_.bindUniform(kBindView);
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, commands_.buffer().id());
  glEnable(GL_CULL_FACE);  // double-sided surfaces are two draws
  for (const Run& run : runs) {
    const gpu::Buffer& geometry = world.residency().geometry().page(run.state.geometry_page);
    geometry.bindStorage(kBindGeometry);
    indices_.bind(geometry);
    const SurfaceKind& kind = run.state.kind;
    programs_.at(kind).use();
    units_.bind(world, run.state.textures);
    (kind.glossy.bands > 0 ? glossy_draws_ : draws_).bindStorage(kBindDraws);
    if (isGlossy(kind.receiver())) {
      world.residency().rows().page(run.state.rows_page).bindStorage(kBindRows);
      world.residency().samples().page(run.state.samples_page).bindStorage(kBindSamples);
    } else if (!kind.dark) {
      world.residency().radiance().page(run.state.radiance_page).bindStorage(kBindRadiance);
    }
    if (kind.glossy.bands > 0)
      units_.bindGlossy(world, run.state.textures, run.state.bundle, run.state.brdf_table);
    if (kind.layered) seen_sky_->bindKernel(kUnitSeenKernel);
    if (kind.texels)
      world.residency().draws()[static_cast<std::size_t>(run.state.irradiance)].irradiance.bind(
          kUnitIrradiance);
    for (std::size_t m = 0; m < modules_.size(); ++m)
      if ((kind.modules & bitOf(m)) != 0) modules_[m]->bindFor(kind.receiver());
    glFrontFace(run.state.clockwise ? GL_CW : GL_CCW);
    DrawIndices::draw(run.first_command, run.command_count, counters);
  }
  glFrontFace(GL_CCW);
  glDisable(GL_CULL_FACE);
  units_.unbindSamplers();
}

void Surfaces::drawOpaque(World& world, gpu::Counters& counters) {
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
  drawRuns(world, opaque_, counters);
}

void Surfaces::drawBlended(World& world, gpu::Counters& counters) {
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  drawRuns(world, blended_, counters);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
}

}  // namespace lambent::frame
