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

}  // namespace

Surfaces::Surfaces() : draws_("surface draws"), commands_("surface commands"), view_("view") {}

Result<Surfaces> Surfaces::create(bool finest_texels) {
  Surfaces surfaces;
  for (const bool normal_mapped : {false, true}) {
    std::vector<gpu::Define> defines;
    if (finest_texels) defines.push_back({"LAMBENT_FINEST_TEXELS", "1"});
    if (normal_mapped) defines.push_back({"LAMBENT_NORMAL_MAPPED", "1"});
    Result<gpu::Program> program = gpu::Program::create(
        "surface", {{GL_VERTEX_SHADER, "surface.vert"}, {GL_FRAGMENT_SHADER, "surface.frag"}}, kShaders,
        defines);
    if (!program) return failAgain(program.error());
    surfaces.programs_[normal_mapped ? 1 : 0] = std::move(*program);
  }
  surfaces.vertices_ = gpu::VertexArray("surface");
  return surfaces;
}

void Surfaces::collect(World& world, const effects::diffuse::Diffuse& diffuse, glm::vec3 eye_ws,
                       std::vector<Item>& opaque, std::vector<Item>& blended) {
  const streaming::Residency& residency = world.residency();
  for (std::uint32_t i = 0; i < residency.draws().size(); ++i) {
    const streaming::ResidentDraw& draw = residency.draws()[i];
    if (!diffuse.shaded(i)) continue;
    const streaming::ResidentMesh& mesh = residency.meshes()[draw.mesh];
    const glm::mat4& world_from_mesh = records_[i].world_from_mesh;
    Item item{.state = {.geometry_page = mesh.block.page,
                        .radiance_page = draw.radiance.page,
                        .textures = texturesOf(world, i, records_[i]),
                        .normal_mapped = normalMapped(world, i),
                        .clockwise = (glm::determinant(glm::mat3(world_from_mesh)) < 0.0f) != draw.back},
              .draw = i,
              .distance = glm::distance(eye_ws, glm::vec3(world_from_mesh * glm::vec4(mesh.center, 1.0f)))};
    (records_[i].alpha_mode == kAlphaBlend ? blended : opaque).push_back(item);
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
                          world.transformsVersion() == transforms_seen_ &&
                          world.lampsVersion() == lamps_seen_ && shaded == shaded_seen_;
  if (scene_same && (blended_.empty() || view.eye_ws == eye_seen_ws_)) return;
  residency_seen_ = residency.version();
  transforms_seen_ = world.transformsVersion();
  lamps_seen_ = world.lampsVersion();
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

void Surfaces::drawRuns(World& world, const std::vector<Run>& runs, gpu::Counters& counters) {
  if (runs.empty()) return;
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
    programs_[run.state.normal_mapped ? 1 : 0].use();
    units_.bind(world, run.state.textures);
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
