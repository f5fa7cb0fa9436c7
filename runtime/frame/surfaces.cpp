#include "runtime/frame/surfaces.hpp"

#include <algorithm>
#include <numeric>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "lambent_frame_embedded.hpp"

namespace lambent::frame {

namespace {

constexpr gpu::FindText kShaders[] = {&embedded::lambent_frame::find};
constexpr GLuint kDrawIndexAttribute = 0;

struct ViewBlock {
  glm::mat4 view_from_world, clip_from_view;
};

gltf::Material materialOf(const World& world, const streaming::ResidentDraw& draw) {
  const auto& materials = world.residency().bundles()[draw.bundle].materials;
  return draw.material >= 0 ? materials[static_cast<std::size_t>(draw.material)] : gltf::Material{};
}

SurfaceDraw describe(const World& world, std::size_t index) {
  const streaming::ResidentDraw& draw = world.residency().draws()[index];
  const streaming::ResidentMesh& mesh = world.residency().meshes()[draw.mesh];
  const gltf::Material material = materialOf(world, draw);
  const std::uint32_t set = std::min(material.base_color_texture.texcoord, 1u);
  const std::uint32_t texcoords = mesh.texcoords_word[set];
  return {.world_from_mesh = world.worldFromMesh(index),
          .base_color = material.base_color,
          .positions_word = mesh.positions_word,
          .texcoords_word = texcoords,
          .colors_word = mesh.colors_word,
          .radiance_word = draw.radiance.word(),
          .alpha_mode = static_cast<uint>(material.alpha_mode),
          .alpha_cutoff = material.alpha_cutoff,
          .textured = material.base_color_texture.texture >= 0 && texcoords != kAbsent ? 1u : 0u,
          .pad = 0};
}

}  // namespace

Surfaces::Surfaces() : draws_("surface draws"), commands_("surface commands"), view_("view") {}

Result<Surfaces> Surfaces::create(bool finest_texels) {
  Surfaces surfaces;
  std::vector<gpu::Define> defines;
  if (finest_texels) defines.push_back({"LAMBENT_FINEST_TEXELS", "1"});
  Result<gpu::Program> program = gpu::Program::create(
      "surface", {{GL_VERTEX_SHADER, "surface.vert"}, {GL_FRAGMENT_SHADER, "surface.frag"}}, kShaders,
      defines);
  if (!program) return failAgain(program.error());
  surfaces.program_ = std::move(*program);
  surfaces.vertices_ = gpu::VertexArray("surface");
  surfaces.white_ = gpu::Texture("white", {.format = GL_RGBA8});
  constexpr std::uint8_t kWhite[] = {255, 255, 255, 255};
  glTextureSubImage2D(surfaces.white_.id(), 0, 0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, kWhite);
  return surfaces;
}

void Surfaces::collect(World& world, const effects::diffuse::Diffuse& diffuse, glm::vec3 eye_ws,
                       std::vector<Item>& opaque, std::vector<Item>& blended) {
  const streaming::Residency& residency = world.residency();
  for (std::uint32_t i = 0; i < residency.draws().size(); ++i) {
    const streaming::ResidentDraw& draw = residency.draws()[i];
    if (!diffuse.shaded(i)) continue;
    const streaming::ResidentMesh& mesh = residency.meshes()[draw.mesh];
    const gltf::Material material = materialOf(world, draw);
    const glm::mat4& world_from_mesh = records_[i].world_from_mesh;
    Item item{.state = {.geometry_page = mesh.block.page,
                        .radiance_page = draw.radiance.page,
                        .bundle = -1,
                        .texture = -1,
                        .clockwise = (glm::determinant(glm::mat3(world_from_mesh)) < 0.0f) != draw.back},
              .draw = i,
              .distance = glm::distance(eye_ws, glm::vec3(world_from_mesh * glm::vec4(mesh.center, 1.0f)))};
    if (records_[i].textured != 0) {
      item.state.bundle = static_cast<std::int32_t>(draw.bundle);
      item.state.texture = material.base_color_texture.texture;
    }
    (material.alpha_mode == gltf::AlphaMode::Blend ? blended : opaque).push_back(item);
  }
}

void Surfaces::appendRuns(const World& world, const std::vector<Item>& items, std::vector<Run>& runs,
                          std::vector<Command>& commands) const {
  for (const Item& item : items) {
    const streaming::ResidentMesh& mesh =
        world.residency().meshes()[world.residency().draws()[item.draw].mesh];
    if (runs.empty() || runs.back().state != item.state)
      runs.push_back({item.state, static_cast<std::uint32_t>(commands.size()), 0});
    ++runs.back().command_count;
    commands.push_back({mesh.index_count, 1, mesh.indices_word, 0, item.draw});
  }
}

void Surfaces::prepare(World& world, const effects::diffuse::Diffuse& diffuse, const spec::View& view,
                       gpu::Counters& counters) {
  const ViewBlock block{view.view_from_world, view.clip_from_view};
  view_.assign(std::span<const ViewBlock>(&block, 1));
  const streaming::Residency& residency = world.residency();
  std::size_t shaded = 0;
  for (std::size_t i = 0; i < residency.draws().size(); ++i) shaded += diffuse.shaded(i) ? 1 : 0;
  const bool scene_same = residency.version() == residency_seen_ &&
                          world.transformsVersion() == transforms_seen_ && shaded == shaded_seen_;
  if (scene_same && (blended_.empty() || view.eye_ws == eye_seen_ws_)) return;
  residency_seen_ = residency.version();
  transforms_seen_ = world.transformsVersion();
  shaded_seen_ = shaded;
  eye_seen_ws_ = view.eye_ws;

  records_.clear();
  for (std::size_t i = 0; i < residency.draws().size(); ++i) records_.push_back(describe(world, i));
  std::vector<Item> opaque, blended;
  collect(world, diffuse, view.eye_ws, opaque, blended);
  std::stable_sort(opaque.begin(), opaque.end(),
                   [](const Item& a, const Item& b) { return a.state < b.state; });
  std::stable_sort(blended.begin(), blended.end(),
                   [](const Item& a, const Item& b) { return a.distance > b.distance; });
  std::vector<Command> commands;
  opaque_.clear();
  blended_.clear();
  appendRuns(world, opaque, opaque_, commands);
  appendRuns(world, blended, blended_, commands);
  draws_.assign(std::span<const SurfaceDraw>(records_));
  commands_.assign(std::span<const Command>(commands));
  counters.uploaded_bytes += records_.size() * sizeof(SurfaceDraw) + commands.size() * sizeof(Command);

  // gl_DrawID is not in OpenGL 4.5: an attribute that steps once per instance gives the base instance back.
  if (draw_indices_.byteCount() < 4 * records_.size()) {
    std::vector<std::uint32_t> indices(2 * records_.size());
    std::iota(indices.begin(), indices.end(), 0u);
    draw_indices_ = gpu::Buffer("draw indices", 4 * indices.size());
    draw_indices_.write(0, std::span<const std::uint32_t>(indices));
    const GLuint array = vertices_.id();
    glVertexArrayVertexBuffer(array, 0, draw_indices_.id(), 0, 4);
    glVertexArrayBindingDivisor(array, 0, 1);
    glVertexArrayAttribIFormat(array, kDrawIndexAttribute, 1, GL_UNSIGNED_INT, 0);
    glVertexArrayAttribBinding(array, kDrawIndexAttribute, 0);
    glEnableVertexArrayAttrib(array, kDrawIndexAttribute);
  }
}

void Surfaces::bindTexture(const World& world, const State& state) {
  const gpu::Texture* texture = &white_;
  gltf::Sampler wanted;
  if (state.texture >= 0) {
    const streaming::ResidentBundle& bundle =
        world.residency().bundles()[static_cast<std::size_t>(state.bundle)];
    const gltf::Texture& described = bundle.textures[static_cast<std::size_t>(state.texture)];
    wanted = described.sampler;
    if (described.image >= 0 && bundle.images[static_cast<std::size_t>(described.image)])
      texture = &bundle.images[static_cast<std::size_t>(described.image)];
  }
  auto& sampler = samplers_[{wanted.wrap_s, wanted.wrap_t, wanted.mag_filter, wanted.min_filter}];
  if (!sampler) sampler = gpu::Sampler(wanted.wrap_s, wanted.wrap_t, wanted.mag_filter, wanted.min_filter);
  texture->bind(0);
  glBindSampler(0, sampler.id());
}

void Surfaces::drawRuns(World& world, const std::vector<Run>& runs, gpu::Counters& counters) {
  if (runs.empty()) return;
  program_.use();
  glBindVertexArray(vertices_.id());
  glBindBufferBase(GL_UNIFORM_BUFFER, kBindView, view_.buffer().id());
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, commands_.buffer().id());
  draws_.bindStorage(kBindDraws);
  glEnable(GL_CULL_FACE);  // double-sided surfaces are two draws
  for (const Run& run : runs) {
    const gpu::Buffer& geometry = world.residency().geometry().page(run.state.geometry_page);
    geometry.bindStorage(kBindGeometry);
    glVertexArrayElementBuffer(vertices_.id(), geometry.id());
    world.residency().radiance().page(run.state.radiance_page).bindStorage(kBindRadiance);
    bindTexture(world, run.state);
    glFrontFace(run.state.clockwise ? GL_CW : GL_CCW);
    glMultiDrawElementsIndirect(
        GL_TRIANGLES, GL_UNSIGNED_INT,
        reinterpret_cast<const void*>(std::size_t{run.first_command} * sizeof(Command)),
        static_cast<GLsizei>(run.command_count), 0);
    counters.draws += run.command_count;
    ++counters.draw_calls;
  }
  glFrontFace(GL_CCW);
  glDisable(GL_CULL_FACE);
  glBindSampler(0, 0);
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
