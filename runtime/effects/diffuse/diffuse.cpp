#include "runtime/effects/diffuse/diffuse.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "lambent_effects_diffuse_embedded.hpp"
#include "lambent_transfer_embedded.hpp"

namespace lambent::effects::diffuse {

const gpu::FindText kDiffuseShaders[2] = {&embedded::lambent_effects_diffuse::find,
                                          &embedded::lambent_transfer::find};

static_assert(transfer::kLightStride == lighting::GroupLights::kStride &&
              transfer::kMaxWorkGroupsX == gpu::WorkList::kMaxGroupsX);

namespace {

// Returns the order that is compiled into the kernel; 0 selects the kernel that loops over any order.
std::uint32_t variantOf(std::uint32_t order) {
  return order >= 2 && order <= 6 ? order : 0;
}

DrawRecord describeDraw(const streaming::Residency& residency, const streaming::ResidentDraw& draw,
                        std::uint32_t light, evaluate::TransferMode mode) {
  const streaming::ResidentGroup& group = residency.groups()[draw.group];
  const streaming::ResidentMesh& mesh = residency.meshes()[draw.mesh];
  DrawRecord record{};
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      record.group_from_mesh_normal[4 * column + row] = draw.group_from_mesh_normal[column][row];
  record.light = light;
  record.order = group.order;
  record.vertex_count = mesh.vertex_count;
  record.normals_word = mesh.normals_word;
  record.rows_word = draw.rows && mode != evaluate::TransferMode::Unshadowed ? draw.rows.word() : kNoRows;
  record.row_entries = draw.row_entries;
  const streaming::SampleStretch samples = group.stretchOf(draw.form());
  record.first_sample = samples.first_sample;
  record.first_output = samples.first_output;
  record.radiance_word = draw.radiance.word();
  record.outputs = draw.outputs;
  if (draw.texel_rows && draw.irradiance) {
    record.texels = draw.texels;
    record.texels_word = mode != evaluate::TransferMode::Unshadowed ? draw.texel_rows.word() : kNoRows;
  }
  return record;
}

}  // namespace

Diffuse::Diffuse()
    : transfers_table_("diffuse transfers"),
      places_table_("diffuse places"),
      draws_table_("diffuse draws"),
      products_("diffuse products"),
      project_work_("diffuse project work"),
      samples_work_("diffuse samples work"),
      adding_work_("diffuse adding work"),
      vertices_work_("diffuse vertices work") {}

Result<void> Diffuse::shade(streaming::Residency& residency, const lighting::GroupLights& lights,
                            evaluate::TransferMode mode, gpu::Counters& counters,
                            const evaluate::ShadedKinds& kinds) {
  const bool other_way = way_changed_.renew(mode, lights.hasKeys(), lights.hasPartedLamps());
  if (other_way) {  // shades everything anew
    cells_changed_.clear();
    draws_changed_.clear();
  }
  if (layout_changed_.renew(residency.version(), lights.groupCount()) || other_way)
    rebuildTables(residency, lights, mode);
  shaded_ = {};
  collectCells(residency, lights, mode, kinds);
  vertices_work_.clear();
  texel_draws_.clear();
  if (kinds.surfaces) collectDraws(residency, lights);
  if (Result<void> run = runCells(residency, lights, counters); !run) return run;
  return runDraws(residency, lights, counters);
}

void Diffuse::rebuildTables(const streaming::Residency& residency, const lighting::GroupLights& lights,
                            evaluate::TransferMode mode) {
  tables_ = {};
  for (const streaming::ResidentCell& cell : residency.cells()) {
    if (cell.matrices())
      tables_.addNone();
    else
      tables_.add(cell, lights, mode);
  }
  for (const streaming::ResidentDraw& draw : residency.draws())
    tables_.draws.push_back(describeDraw(residency, draw, lights.firstOf(draw.group), mode));
  transfers_table_.assign(std::span<const transfer::TransferRecord>(tables_.transfers));
  places_table_.assign(std::span<const std::uint32_t>(tables_.places));
  draws_table_.assign(std::span<const DrawRecord>(tables_.draws));
  products_.reserve(tables_.product_count * sizeof(glm::vec4));
  cells_changed_.follow(residency.cells(), &streaming::ResidentCell::id);
  draws_changed_.follow(residency.draws(), &streaming::ResidentDraw::id);
  group_shaded_.follow(residency.groups(), &streaming::ResidentGroup::id);
}

void Diffuse::collectCells(const streaming::Residency& residency, const lighting::GroupLights& lights,
                           evaluate::TransferMode mode, const evaluate::ShadedKinds& kinds) {
  project_work_.clear();
  samples_work_.clear();
  adding_work_.clear();
  if (mode == evaluate::TransferMode::Unshadowed) return;
  for (std::uint32_t i = 0; i < tables_.cells.size(); ++i) {
    const streaming::ResidentCell& cell = residency.cells()[i];
    const evaluate::TransferTable::Cell range = tables_.cells[i];
    if (!kinds.has(cell.domain) || !cell.usable() || range.count == 0) continue;
    if (!cells_changed_[i].renew(cell.version, evaluate::lightVersion(lights, cell))) continue;
    ++group_shaded_[cell.group];
    ++shaded_.cells;
    for (std::uint32_t t = range.first; t < range.first + range.count; ++t) {
      const transfer::TransferRecord& record = tables_.transfers[t];
      const std::uint32_t order = cell.transfers[t - range.first].shape.order;
      project_work_.add({variantOf(order), record.outputs, cell.block.page}, t,
                        record.light_count * record.clusters * record.outputs, transfer::kUnitsPerGroup);
      (record.accumulate != 0 ? adding_work_ : samples_work_)
          .add({record.light_count > 1 ? 1u : 0u, record.outputs, cell.block.page,
                residency.groups()[cell.group].samples.page},
               t, record.sample_count, transfer::kWorkGroupSize);
    }
  }
}

void Diffuse::collectDraws(const streaming::Residency& residency, const lighting::GroupLights& lights) {
  for (std::uint32_t i = 0; i < tables_.draws.size(); ++i) {
    const streaming::ResidentDraw& draw = residency.draws()[i];
    if (!draw.radiance) continue;
    if (!draws_changed_[i].renew(draw.version, lights.versionOf(draw.group), group_shaded_[draw.group]))
      continue;
    ++shaded_.draws;
    if (tables_.draws[i].texels > 0) texel_draws_.push_back(i);
    const streaming::ResidentGroup& group = residency.groups()[draw.group];
    const streaming::ResidentMesh& mesh = residency.meshes()[draw.mesh];
    vertices_work_.add({variantOf(group.order), draw.outputs, draw.rows.page, mesh.block.page,
                        group.samples.page, draw.radiance.page},
                       i, mesh.vertex_count, transfer::kWorkGroupSize);
  }
}

Result<const gpu::Program*> Diffuse::program(Stage stage, std::uint32_t kind, std::uint32_t outputs) {
  constexpr std::array<const char*, kStageCount> kFiles = {"project_vectors.comp", "shade_vectors.comp",
                                                           "diffuse_vertices.comp"};
  auto& programs = programs_[stage];
  const std::array<std::uint32_t, 2> variant = {kind, stage == Project ? 0 : outputs};
  if (const auto found = programs.find(variant); found != programs.end()) return &found->second;
  std::vector<gpu::Define> defines;
  if (kind != 0)
    defines.push_back(stage == Samples ? gpu::Define{"LAMBENT_MANY_LIGHTS", "1"}
                                       : gpu::Define{"LAMBENT_ORDER", std::to_string(kind)});
  if (stage != Project) defines.push_back({"LAMBENT_OUTPUTS", std::to_string(outputs)});
  Result<gpu::Program> made =
      gpu::Program::create(fmt::format("{} kind {} outputs {}", kFiles[stage], kind, outputs),
                           {{GL_COMPUTE_SHADER, kFiles[stage]}}, kDiffuseShaders, defines);
  if (!made) return failAgain(made.error());
  return &programs.emplace(variant, std::move(*made)).first->second;
}

Result<void> Diffuse::runCells(streaming::Residency& residency, const lighting::GroupLights& lights,
                               gpu::Counters& counters) {
  if (project_work_.empty()) return {};
  project_work_.upload(counters);
  samples_work_.upload(counters);
  if (!adding_work_.empty()) adding_work_.upload(counters);
  lights.bindStorage(transfer::kBindLights);
  transfers_table_.bindStorage(transfer::kBindTransfers);
  places_table_.bindStorage(transfer::kBindPlaces);
  products_.bindStorage(transfer::kBindProducts);
  std::size_t index = 0;
  for (const auto& [key, items] : project_work_.batches()) {
    const Result<const gpu::Program*> kernel = program(Project, key[0], key[1]);
    if (!kernel) return failAgain(kernel.error());
    (*kernel)->use();
    residency.transfer().page(key[2]).bindStorage(transfer::kBindTransfer);
    project_work_.dispatch(index++, transfer::kBindWork, counters);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  if (Result<void> run = runSamples(residency, samples_work_, counters); !run) return run;
  return runSamples(residency, adding_work_, counters);
}

Result<void> Diffuse::runSamples(streaming::Residency& residency, const gpu::WorkList& work,
                                 gpu::Counters& counters) {
  if (work.empty()) return {};
  std::size_t index = 0;
  for (const auto& [key, items] : work.batches()) {
    const Result<const gpu::Program*> kernel = program(Samples, key[0], key[1]);
    if (!kernel) return failAgain(kernel.error());
    (*kernel)->use();
    residency.transfer().page(key[2]).bindStorage(transfer::kBindTransfer);
    residency.samples().page(key[3]).bindStorage(transfer::kBindSamples);
    work.dispatch(index++, transfer::kBindWork, counters);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return {};
}

Result<void> Diffuse::runDraws(streaming::Residency& residency, const lighting::GroupLights& lights,
                               gpu::Counters& counters) {
  if (vertices_work_.empty()) return {};
  vertices_work_.upload(counters);
  lights.bindStorage(transfer::kBindLights);
  draws_table_.bindStorage(kBindDraws);
  std::size_t index = 0;
  for (const auto& [key, items] : vertices_work_.batches()) {
    const Result<const gpu::Program*> kernel = program(Vertices, key[0], key[1]);
    if (!kernel) return failAgain(kernel.error());
    (*kernel)->use();
    // A page may not exist if no draw of the batch has anything in it; any buffer can take its place.
    const auto bind = [&](gpu::Arena& arena, std::uint32_t page, std::uint32_t binding) {
      if (page < arena.pageCount() && arena.page(page))
        arena.page(page).bindStorage(binding);
      else
        draws_table_.bindStorage(binding);
    };
    bind(residency.rows(), key[2], kBindRows);
    bind(residency.geometry(), key[3], kBindGeometry);
    bind(residency.samples(), key[4], transfer::kBindSamples);
    bind(residency.radiance(), key[5], kBindRadiance);
    vertices_work_.dispatch(index++, transfer::kBindWork, counters);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return texel_draws_.empty() ? Result<void>() : runTexels(residency, counters);
}

// Samples that are not shaded leave their texels empty, as all do in the unshadowed mode, and the vertices
// show.
Result<void> Diffuse::runTexels(streaming::Residency& residency, gpu::Counters& counters) {
  if (!texels_program_) {
    Result<gpu::Program> made = gpu::Program::create(
        "diffuse_texels.comp", {{GL_COMPUTE_SHADER, "diffuse_texels.comp"}}, kDiffuseShaders, {});
    if (!made) return failAgain(made.error());
    texels_program_ = std::move(*made);
  }
  texels_program_.use();
  for (const std::uint32_t i : texel_draws_) {
    const streaming::ResidentDraw& draw = residency.draws()[i];
    residency.rows().page(draw.texel_rows.page).bindStorage(kBindRows);
    residency.samples().page(residency.groups()[draw.group].samples.page).bindStorage(transfer::kBindSamples);
    glBindImageTexture(0, draw.irradiance.id(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA16F);
    glUniform1ui(0, i);
    const GLuint groups = (draw.texels + kTexelGroupSize - 1) / kTexelGroupSize;
    glDispatchCompute(groups, groups, 1);
    ++counters.dispatches;
  }
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
                  GL_TEXTURE_UPDATE_BARRIER_BIT);
  for (const std::uint32_t i : texel_draws_) glGenerateTextureMipmap(residency.draws()[i].irradiance.id());
  return {};
}

}  // namespace lambent::effects::diffuse
