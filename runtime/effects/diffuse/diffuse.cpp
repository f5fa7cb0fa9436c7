#include "runtime/effects/diffuse/diffuse.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "lambent_effects_diffuse_embedded.hpp"

namespace lambent::effects::diffuse {

static_assert(kLightStride == lighting::GroupLights::kStride &&
              kMaxWorkGroupsX == gpu::WorkList::kMaxGroupsX);

namespace {

constexpr gpu::FindText kShaders[] = {&embedded::lambent_effects_diffuse::find};

// Kernels with the order compiled in; 0 is the one that loops over any order.
std::uint32_t variantOf(std::uint32_t order) {
  return order >= 2 && order <= 6 ? order : 0;
}

DrawRecord describeDraw(const streaming::Residency& residency, const streaming::ResidentDraw& draw,
                        std::uint32_t light, TransferMode mode) {
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
  record.rows_word = draw.rows && mode != TransferMode::Unshadowed ? draw.rows.word() : kNoRows;
  record.row_entries = draw.row_entries;
  record.first_sample = group.sampleBase(draw.outputs);
  record.radiance_word = draw.radiance.word();
  record.outputs = draw.outputs;
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
                            TransferMode mode, gpu::Counters& counters, const ShadedKinds& kinds) {
  const bool same_way = mode == mode_seen_ && lights.hasKeys() == keys_seen_;
  if (residency.version() != residency_seen_ || lights.groupCount() != groups_seen_ || !same_way) {
    if (!same_way) {  // everything anew
      cells_seen_.clear();
      draws_seen_.clear();
    }
    rebuildTables(residency, lights, mode);
  }
  shaded_ = {};
  collectCells(residency, lights, kinds);
  vertices_work_.clear();
  if (kinds.surfaces) collectDraws(residency, lights);
  if (Result<void> run = runCells(residency, lights, counters); !run) return run;
  return runDraws(residency, lights, counters);
}

void Diffuse::rebuildTables(const streaming::Residency& residency, const lighting::GroupLights& lights,
                            TransferMode mode) {
  residency_seen_ = residency.version();
  groups_seen_ = lights.groupCount();
  mode_seen_ = mode;
  keys_seen_ = lights.hasKeys();
  tables_ = {};
  for (const streaming::ResidentCell& cell : residency.cells()) {
    if (cell.matrices())
      tables_.addNone();
    else
      tables_.add(cell, lights, mode);
  }
  for (const streaming::ResidentDraw& draw : residency.draws())
    tables_.draws.push_back(describeDraw(residency, draw, lights.firstOf(draw.group), mode));
  transfers_table_.assign(std::span<const TransferRecord>(tables_.transfers));
  places_table_.assign(std::span<const std::uint32_t>(tables_.places));
  draws_table_.assign(std::span<const DrawRecord>(tables_.draws));
  products_.reserve(tables_.product_count * sizeof(glm::vec4));
  cells_seen_.follow(residency.cells(), &streaming::ResidentCell::id);
  draws_seen_.follow(residency.draws(), &streaming::ResidentDraw::id);
  group_shaded_.follow(residency.groups(), &streaming::ResidentGroup::id);
}

void Diffuse::collectCells(const streaming::Residency& residency, const lighting::GroupLights& lights,
                           const ShadedKinds& kinds) {
  project_work_.clear();
  samples_work_.clear();
  adding_work_.clear();
  if (mode_seen_ == TransferMode::Unshadowed) return;
  for (std::uint32_t i = 0; i < tables_.cells.size(); ++i) {
    const streaming::ResidentCell& cell = residency.cells()[i];
    const TransferTable::Cell range = tables_.cells[i];
    if (!kinds.has(cell.kind) || !cell.usable() || range.count == 0) continue;
    Seen& seen = cells_seen_[i];
    const std::uint64_t light = lightVersion(lights, cell);
    if (seen.version == cell.version && seen.light == light) continue;
    seen = {.version = cell.version, .light = light, .cells = 0};
    ++group_shaded_[cell.group];
    ++shaded_.cells;
    for (std::uint32_t t = range.first; t < range.first + range.count; ++t) {
      const TransferRecord& record = tables_.transfers[t];
      const std::uint32_t order = cell.transfers[t - range.first].shape.order;
      project_work_.add({variantOf(order), record.outputs, cell.block.page}, t,
                        record.light_count * record.clusters * record.outputs, kUnitsPerGroup);
      (record.accumulate != 0 ? adding_work_ : samples_work_)
          .add({record.light_count > 1 ? 1u : 0u, record.outputs, cell.block.page,
                residency.groups()[cell.group].samples.page},
               t, record.sample_count, kWorkGroupSize);
    }
  }
}

void Diffuse::collectDraws(const streaming::Residency& residency, const lighting::GroupLights& lights) {
  for (std::uint32_t i = 0; i < tables_.draws.size(); ++i) {
    const streaming::ResidentDraw& draw = residency.draws()[i];
    if (!draw.radiance) continue;
    Seen& seen = draws_seen_[i];
    const Seen now{
        .version = draw.version, .light = lights.versionOf(draw.group), .cells = group_shaded_[draw.group]};
    if (seen.version == now.version && seen.light == now.light && seen.cells == now.cells) continue;
    seen = now;
    ++shaded_.draws;
    const streaming::ResidentGroup& group = residency.groups()[draw.group];
    const streaming::ResidentMesh& mesh = residency.meshes()[draw.mesh];
    vertices_work_.add({variantOf(group.order), draw.outputs, draw.rows.page, mesh.block.page,
                        group.samples.page, draw.radiance.page},
                       i, mesh.vertex_count, kWorkGroupSize);
  }
}

Result<const gpu::Program*> Diffuse::program(Stage stage, std::uint32_t kind, std::uint32_t outputs) {
  constexpr std::array<const char*, kStageCount> kFiles = {"diffuse_project.comp", "diffuse_samples.comp",
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
                           {{GL_COMPUTE_SHADER, kFiles[stage]}}, kShaders, defines);
  if (!made) return failAgain(made.error());
  return &programs.emplace(variant, std::move(*made)).first->second;
}

Result<void> Diffuse::runCells(streaming::Residency& residency, const lighting::GroupLights& lights,
                               gpu::Counters& counters) {
  if (project_work_.empty()) return {};
  project_work_.upload(counters);
  samples_work_.upload(counters);
  if (!adding_work_.empty()) adding_work_.upload(counters);
  lights.bindStorage(kBindLights);
  transfers_table_.bindStorage(kBindTransfers);
  places_table_.bindStorage(kBindPlaces);
  products_.bindStorage(kBindProducts);
  std::size_t index = 0;
  for (const auto& [key, items] : project_work_.batches()) {
    const Result<const gpu::Program*> kernel = program(Project, key[0], key[1]);
    if (!kernel) return failAgain(kernel.error());
    (*kernel)->use();
    residency.transfer().page(key[2]).bindStorage(kBindTransfer);
    project_work_.dispatch(index++, kBindWork, counters);
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
    residency.transfer().page(key[2]).bindStorage(kBindTransfer);
    residency.samples().page(key[3]).bindStorage(kBindSamples);
    work.dispatch(index++, kBindWork, counters);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return {};
}

Result<void> Diffuse::runDraws(streaming::Residency& residency, const lighting::GroupLights& lights,
                               gpu::Counters& counters) {
  if (vertices_work_.empty()) return {};
  vertices_work_.upload(counters);
  lights.bindStorage(kBindLights);
  draws_table_.bindStorage(kBindDraws);
  std::size_t index = 0;
  for (const auto& [key, items] : vertices_work_.batches()) {
    const Result<const gpu::Program*> kernel = program(Vertices, key[0], key[1]);
    if (!kernel) return failAgain(kernel.error());
    (*kernel)->use();
    // A page that no draw of the batch has anything in yet may not exist: any buffer will do in its place.
    const auto bind = [&](gpu::Arena& arena, std::uint32_t page, std::uint32_t binding) {
      if (page < arena.pageCount() && arena.page(page))
        arena.page(page).bindStorage(binding);
      else
        draws_table_.bindStorage(binding);
    };
    bind(residency.rows(), key[2], kBindRows);
    bind(residency.geometry(), key[3], kBindGeometry);
    bind(residency.samples(), key[4], kBindSamples);
    bind(residency.radiance(), key[5], kBindRadiance);
    vertices_work_.dispatch(index++, kBindWork, counters);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return {};
}

}  // namespace lambent::effects::diffuse
