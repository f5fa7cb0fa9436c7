#include "runtime/debug/data_view.hpp"

#include <algorithm>
#include <bit>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>

#include "runtime/bundle/description.hpp"
#include "runtime/debug/overlays.hpp"
#include "runtime/draws/surface_record.hpp"

namespace lambent::frame {

namespace {

using evaluate::TransferValue;

// These are the uniform locations of data_view.glsl.
constexpr GLint kDrawIndex = 0, kRange = 1, kWireColor = 2;

struct CodingErrors {
  std::vector<float> of_cells;  // per cell, the larger error of its transfers of distant light
  // The colour range for surfaces ends here: at twice the requested bound, so that the bound is in the
  // middle; more if an error is larger.
  float range_end = 0.0f;
};

// Collects the errors that the bakes recorded.
CodingErrors errorsOf(const World& world) {
  CodingErrors errors;
  const streaming::Residency& residency = world.residency();
  for (std::uint32_t c = 0; c < residency.cells().size(); ++c) {
    const streaming::ResidentGroup& group = residency.groups()[residency.cells()[c].group];
    const bundle::Cell& cell =
        world.description(group.bundle).groups[group.index.value].cells[c - group.first_cell];
    float error = 0.0f;
    for (const bundle::CellTransfer& transfer : cell.transfers) {
      if (!transfer.fromEnvironment()) continue;
      error = std::max(error, transfer.error);
      if (cell.domain == transfer::Domain::Vertex)
        errors.range_end = std::max({errors.range_end, 2.0f * transfer.error_bound, transfer.error});
    }
    errors.of_cells.push_back(error);
  }
  return errors;
}

// Reads the importance of all samples from their bundles, in the order of TransferValues.
Result<std::vector<evaluate::SampleValue>> importanceOf(const World& world) {
  std::vector<evaluate::SampleValue> values;
  const streaming::Residency& residency = world.residency();
  for (const streaming::ResidentGroup& group : residency.groups())
    for (std::uint32_t c = 0; c < group.cell_count; ++c) {
      const streaming::ResidentCell& cell = residency.cells()[group.first_cell + c];
      if (cell.domain != transfer::Domain::Vertex) continue;
      const auto codes = world.reader(group.bundle).readImportance(group.index, bundle::CellIndex{c});
      if (!codes) return failAgain(codes.error());
      const std::size_t first = values.size();
      values.resize(first + cell.sample_count, {.value_bits = 0, .cluster = evaluate::kNoCluster});
      for (std::size_t s = 0; s < codes->size(); ++s)
        if ((*codes)[s] > 0)
          values[first + s] = {std::bit_cast<std::uint32_t>(bundle::importanceOctaves((*codes)[s])), 0};
    }
  return values;
}

TransferValue valueOf(SurfaceView view) {
  if (view == SurfaceView::Importance) return TransferValue::Given;
  if (view == SurfaceView::TransferDc) return TransferValue::Dc;
  return TransferValue::OfCell;
}

}  // namespace

DataView::DataView(bool numbers)
    : numbers_(numbers),
      draws_("data view draws"),
      data_draws_("data view parts"),
      view_("data view"),
      no_vertices_("data view") {}

Result<void> DataView::update(World& world, const lighting::GroupLights& lights, const ViewChoice& choice,
                              evaluate::TransferMode mode, gpu::Counters& counters) {
  choice_ = choice;
  const CodingErrors errors = errorsOf(world);
  legend_ = legendOf(choice, errors.range_end);
  return values_.update(
      world.residency(), lights, {.value = valueOf(choice.view), .mode = mode}, errors.of_cells,
      [&] { return importanceOf(world); }, counters);
}

Result<void> DataView::draw(World& world, const spec::View& view, gpu::Counters& counters) {
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
  return drawAll(world, view, choice_.view == SurfaceView::ClusterIds ? Kind::Clusters : Kind::Values,
                 counters);
}

Result<void> DataView::drawWires(World& world, const spec::View& view, gpu::Counters& counters) {
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  glEnable(GL_POLYGON_OFFSET_FILL);  // another program drew the surfaces themselves
  glPolygonOffset(-1.0f, -2.0f);
  Result<void> done = drawAll(world, view, Kind::Wires, counters);
  glDisable(GL_POLYGON_OFFSET_FILL);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  return done;
}

Result<void> DataView::drawAll(World& world, const spec::View& view, Kind kind, gpu::Counters& counters) {
  if (!programs_.contains(kind)) {
    std::vector<gpu::Define> defines;
    if (kind == Kind::Wires) defines.push_back({"LAMBENT_WIRES", "1"});
    if (kind == Kind::Clusters) defines.push_back({"LAMBENT_CLUSTERS", "1"});
    if (kind != Kind::Wires) defines.push_back({"LAMBENT_VALUES", "1"});
    if (numbers_) defines.push_back({"LAMBENT_FINEST_TEXELS", "1"});
    Result<gpu::Program> made = gpu::Program::create(
        "data view", {{GL_VERTEX_SHADER, "data_view.glsl"}, {GL_FRAGMENT_SHADER, "data_view.glsl"}},
        kDebugShaders, defines);
    if (!made) return failAgain(made.error());
    programs_.emplace(kind, std::move(*made));
  }
  streaming::Residency& residency = world.residency();
  std::vector<SurfaceDraw> draws;
  std::vector<DataDraw> parts;
  for (std::uint32_t i = 0; i < residency.draws().size(); ++i) {
    const streaming::ResidentDraw& draw = residency.draws()[i];
    const streaming::ResidentMesh& mesh = residency.meshes()[draw.mesh];
    draws.push_back(describe(world, i));
    parts.push_back({.indices_word = mesh.indices_word,
                     .rows_word = draw.rows ? draw.rows.word() : kAbsent,
                     .row_entries = draw.row_entries,
                     .vertex_count = mesh.vertex_count,
                     .first_value = kind == Kind::Wires ? 0 : values_.firstOf(draw.group),
                     .pad = {}});
  }
  if (draws.empty()) return {};
  draws_.assign(std::span<const SurfaceDraw>(draws));
  data_draws_.assign(std::span<const DataDraw>(parts));
  const ViewBlock block{view.view_from_world, view.clip_from_view, {}};
  view_.assign(std::span<const ViewBlock>(&block, 1));
  counters.uploaded_bytes += draws.size() * (sizeof(SurfaceDraw) + sizeof(DataDraw));

  programs_.at(kind).use();
  glBindBufferBase(GL_UNIFORM_BUFFER, kBindView, view_.buffer().id());
  draws_.bindStorage(kBindDraws);
  data_draws_.bindStorage(kBindDataDraws);
  if (kind != Kind::Wires) values_.buffer().bindStorage(kBindDataValues);
  glUniform2f(kRange, legend_.min, legend_.max);
  glUniform4f(kWireColor, 0.93f, 0.97f, 1.0f, 0.8f);
  glBindVertexArray(no_vertices_.id());
  glEnable(GL_CULL_FACE);
  for (std::uint32_t i = 0; i < draws.size(); ++i) {
    const streaming::ResidentDraw& draw = residency.draws()[i];
    const streaming::ResidentMesh& mesh = residency.meshes()[draw.mesh];
    if (!mesh.block) continue;
    residency.geometry().page(mesh.block.page).bindStorage(kBindGeometry);
    if (draw.rows)
      residency.rows().page(draw.rows.page).bindStorage(kBindDataRows);
    else
      data_draws_.bindStorage(kBindDataRows);  // any buffer will do, since nothing is read
    units_.bind(world, texturesOf(world, i, draws[i]));
    const bool mirrored = glm::determinant(glm::mat3(draws[i].world_from_mesh)) < 0.0f;
    glFrontFace(mirrored != draw.back ? GL_CW : GL_CCW);
    glUniform1ui(kDrawIndex, i);
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(mesh.index_count));
    ++counters.draws;
    ++counters.draw_calls;
  }
  glFrontFace(GL_CCW);
  glDisable(GL_CULL_FACE);
  units_.unbindSamplers();
  return {};
}

}  // namespace lambent::frame
