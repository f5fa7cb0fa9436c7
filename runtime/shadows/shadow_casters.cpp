#include "runtime/shadows/shadow_casters.hpp"

#include <algorithm>

#include "lambent_draws_embedded.hpp"
#include "lambent_shadows_embedded.hpp"

namespace lambent::frame {

const gpu::FindText kShadowShaders[2] = {&embedded::lambent_shadows::find, &embedded::lambent_draws::find};

namespace {

constexpr float kClear = 0.5f;

// Holds the state that casters must share to go into one multi-draw.
struct State {
  std::uint32_t geometry_page = 0;
  bool masked = false;
  SurfaceTextures textures;
  auto operator<=>(const State&) const = default;
};

struct Run {
  std::size_t tile = 0;
  State state;
  std::uint32_t first_command = 0, command_count = 0;
};

State stateOf(const World& world, const ShadowCaster& caster) {
  State state{.geometry_page = caster.block.page, .masked = caster.masked, .textures = {}};
  if (!caster.masked) return state;
  const std::int32_t texture = world.material(caster.draw).base_color_texture.texture;
  const std::uint32_t bundle = world.residency().draws()[caster.draw].bundle;
  if (texture >= 0) state.textures = {.bundle = static_cast<std::int32_t>(bundle), .base_color = texture};
  return state;
}

void appendRuns(const World& world, const ShadowCasters::Tile& tile, std::size_t index,
                std::vector<Run>& runs, std::vector<DrawCommand>& commands) {
  struct Item {
    State state;
    std::uint32_t draw = 0;
  };
  std::vector<Item> items;
  for (const ShadowCaster* caster : tile.casters) items.push_back({stateOf(world, *caster), caster->draw});
  std::stable_sort(items.begin(), items.end(),
                   [](const Item& a, const Item& b) { return a.state < b.state; });
  for (const Item& item : items) {
    if (runs.empty() || runs.back().tile != index || runs.back().state != item.state)
      runs.push_back({index, item.state, static_cast<std::uint32_t>(commands.size()), 0});
    ++runs.back().command_count;
    const streaming::ResidentMesh& mesh =
        world.residency().meshes()[world.residency().draws()[item.draw].mesh];
    commands.push_back({mesh.index_count, 1, mesh.indices_word, 0, item.draw});
  }
}

}  // namespace

bool ShadowCaster::operator==(const ShadowCaster& other) const {
  return id == other.id && world_from_mesh == other.world_from_mesh && block.page == other.block.page &&
         block.offset == other.block.offset && block.byte_count == other.block.byte_count &&
         masked == other.masked && image_levels == other.image_levels && alpha == other.alpha &&
         alpha_cutoff == other.alpha_cutoff;
}

Result<void> ShadowCasters::compile() {
  for (const bool masked : {false, true}) {
    if (programs_[masked ? 1 : 0]) continue;
    std::vector<gpu::Define> defines;
    if (masked) defines.push_back({"LAMBENT_MASKED", "1"});
    Result<gpu::Program> program = gpu::Program::create(
        label_, {{GL_VERTEX_SHADER, vertex_}, {GL_FRAGMENT_SHADER, fragment_}}, kShadowShaders, defines);
    if (!program) return failAgain(program.error());
    programs_[masked ? 1 : 0] = std::move(*program);
  }
  return {};
}

void ShadowCasters::resize(std::uint32_t width, std::uint32_t height) {
  depths_ = gpu::Texture(label_, {.format = GL_DEPTH_COMPONENT32F, .width = width, .height = height});
  GLuint id = 0;
  glCreateFramebuffers(1, &id);
  target_ = gpu::Handle<gpu::FramebufferTraits>(id);
  glNamedFramebufferTexture(id, GL_DEPTH_ATTACHMENT, depths_.id(), 0);
  glNamedFramebufferDrawBuffer(id, GL_NONE);
}

bool ShadowCasters::follow(const World& world) {
  const streaming::Residency& residency = world.residency();
  if (!changed_.renew(residency.version(), world.transformsVersion(), world.materialsVersion())) return false;
  casters_.clear();
  for (std::uint32_t i = 0; i < residency.draws().size(); ++i) {
    const streaming::ResidentDraw& draw = residency.draws()[i];
    if (draw.back) continue;  // the front's triangles serve both sides (docs/design/vertices.md)
    const streaming::ResidentMesh& mesh = residency.meshes()[draw.mesh];
    const gltf::Material& material = world.material(i);
    // A pane that passes half of the light or more would be wronger as a whole shadow than without one.
    const bool clear = material.transmits() && material.transmission >= kClear;
    if (!mesh.block || material.alpha_mode == gltf::AlphaMode::Blend || clear) continue;
    const scene::Box bounds =
        scene::drawBounds(world.registry(), world.instance(draw.bundle).draws[draw.index]);
    if (bounds.empty()) continue;
    ShadowCaster caster{.draw = i,
                        .id = draw.id,
                        .world_from_mesh = world.worldFromMesh(i),
                        .bounds_ws = bounds,
                        .block = mesh.block,
                        .masked = material.alpha_mode == gltf::AlphaMode::Mask};
    if (caster.masked) {
      caster.alpha = material.base_color.a;
      caster.alpha_cutoff = material.alpha_cutoff;
    }
    if (const std::int32_t texture = material.base_color_texture.texture; caster.masked && texture >= 0) {
      const streaming::ResidentBundle& bundle = residency.bundles()[draw.bundle];
      const std::int32_t image = bundle.textures[static_cast<std::size_t>(texture)].image;
      if (image >= 0 && bundle.images[static_cast<std::size_t>(image)])
        caster.image_levels = bundle.images[static_cast<std::size_t>(image)].desc().levels;
    }
    casters_.push_back(caster);
  }
  return true;
}

void ShadowCasters::draw(World& world, std::span<const Tile> tiles, GLuint binding, gpu::Counters& counters) {
  std::vector<SurfaceDraw> records;
  records.reserve(world.residency().draws().size());
  for (std::size_t i = 0; i < world.residency().draws().size(); ++i) records.push_back(describe(world, i));
  std::vector<Run> runs;
  std::vector<DrawCommand> commands;
  std::vector<std::byte> views;
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    appendRuns(world, tiles[t], t, runs, commands);
    views.insert(views.end(), tiles[t].view.begin(), tiles[t].view.end());
  }
  records_.assign(std::span<const SurfaceDraw>(records));
  commands_.assign(std::span<const DrawCommand>(commands));
  views_.assign(std::span<const std::byte>(views));
  indices_.reserve(records.size());
  counters.uploaded_bytes +=
      records.size() * sizeof(SurfaceDraw) + commands.size() * sizeof(DrawCommand) + views.size();

  glBindFramebuffer(GL_FRAMEBUFFER, target_.id());
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);  // surfaces block light from both sides, as in the bake
  glEnable(GL_SCISSOR_TEST);
  for (const Tile& tile : tiles) {
    glScissor(static_cast<GLint>(tile.x), static_cast<GLint>(tile.y), static_cast<GLsizei>(tile.size),
              static_cast<GLsizei>(tile.size));
    constexpr float kFar = 1.0f;
    glClearBufferfv(GL_DEPTH, 0, &kFar);
  }
  glDisable(GL_SCISSOR_TEST);
  records_.bindStorage(kBindDraws);
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, commands_.buffer().id());
  for (const Run& run : runs) {
    const Tile& tile = tiles[run.tile];
    glViewport(static_cast<GLint>(tile.x), static_cast<GLint>(tile.y), static_cast<GLsizei>(tile.size),
               static_cast<GLsizei>(tile.size));
    constexpr std::size_t kBytes = sizeof(tile.view);
    glBindBufferRange(GL_UNIFORM_BUFFER, binding, views_.buffer().id(),
                      static_cast<GLintptr>(kBytes * run.tile), static_cast<GLsizeiptr>(kBytes));
    const gpu::Buffer& geometry = world.residency().geometry().page(run.state.geometry_page);
    geometry.bindStorage(kBindGeometry);
    indices_.bind(geometry);
    programs_[run.state.masked ? 1 : 0].use();
    if (run.state.masked) units_.bind(world, run.state.textures);
    DrawIndices::draw(run.first_command, run.command_count, counters);
  }
  units_.unbindSamplers();
}

}  // namespace lambent::frame
