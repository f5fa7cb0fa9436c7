#include "runtime/effects/diffuse/diffuse.hpp"

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

bool partCounts(bundle::TransferPart part, TransferMode mode) {
  return mode == TransferMode::Full ||
         (mode == TransferMode::Shadowed && part == bundle::TransferPart::Direct);
}

// Means of all parts first (slot 0), then the resident planes, slots from 1.
CellRecord addCell(const streaming::Residency& residency, const streaming::ResidentCell& cell,
                   std::uint32_t light, TransferMode mode, Tables& tables) {
  const streaming::ResidentGroup& group = residency.groups()[cell.group];
  CellRecord record{.light = light,
                    .first_vector = static_cast<uint>(tables.vectors.size()),
                    .vector_count = 0,
                    .first_product = tables.product_count,
                    .plane_count = 0,
                    .first_output = group.samples.word() / 4 + cell.first_sample,
                    .sample_count = cell.sample_count,
                    .order = 0};
  for (const streaming::ResidentTransfer& transfer : cell.transfers) {
    if (!partCounts(transfer.part, mode) || !transfer.basis_resident) continue;
    // One order for the whole cell picks a specialised kernel; mixed orders take the general one.
    record.order = record.vector_count == 0 || record.order == transfer.order ? transfer.order : 0;
    const uint length = transfer.channels * transfer.columns;
    VectorRecord vector{.basis_word = transfer.basis_word,
                        .codes = 0,
                        .offset = 1.0f,
                        .scale = 0.0f,
                        .channels = transfer.channels,
                        .columns = transfer.columns,
                        .order = transfer.order,
                        .slot = 0};
    tables.vectors.push_back(vector);
    for (uint j = 0; j < transfer.planes_resident; ++j) {
      const streaming::ResidentPlane& plane = transfer.planes[j];
      vector.basis_word += length;
      vector.codes = plane.word | (plane.bits == 16 ? kCodes16Bit : 0u);
      vector.offset = plane.offset;
      vector.scale = plane.scale;
      vector.slot = ++record.plane_count;
      tables.vectors.push_back(vector);
    }
    record.vector_count = static_cast<uint>(tables.vectors.size()) - record.first_vector;
  }
  tables.product_count += 1 + record.plane_count;
  return record;
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
  record.first_sample = group.samples.word() / 4;
  record.radiance_word = draw.radiance.word();
  return record;
}

}  // namespace

Diffuse::Diffuse()
    : cells_table_("diffuse cells"),
      vectors_table_("diffuse vectors"),
      draws_table_("diffuse draws"),
      products_("diffuse products"),
      project_work_("diffuse project work"),
      samples_work_("diffuse samples work"),
      vertices_work_("diffuse vertices work") {}

Result<void> Diffuse::shade(streaming::Residency& residency, const lighting::GroupLights& lights,
                            TransferMode mode, gpu::Counters& counters) {
  if (residency.version() != residency_seen_ || lights.groupCount() != groups_seen_ || mode != mode_seen_) {
    if (mode != mode_seen_) {  // everything anew
      cells_seen_.clear();
      draws_seen_.clear();
    }
    rebuildTables(residency, lights, mode);
  }
  collectCells(residency, lights);
  collectDraws(residency, lights);
  if (Result<void> run = runCells(residency, lights, counters); !run) return run;
  return runDraws(residency, lights, counters);
}

void Diffuse::rebuildTables(const streaming::Residency& residency, const lighting::GroupLights& lights,
                            TransferMode mode) {
  residency_seen_ = residency.version();
  groups_seen_ = lights.groupCount();
  mode_seen_ = mode;
  tables_ = {};
  for (const streaming::ResidentCell& cell : residency.cells())
    tables_.cells.push_back(addCell(residency, cell, lights.firstOf(cell.group), mode, tables_));
  for (const streaming::ResidentDraw& draw : residency.draws())
    tables_.draws.push_back(describeDraw(residency, draw, lights.firstOf(draw.group), mode));
  cells_table_.assign(std::span<const CellRecord>(tables_.cells));
  vectors_table_.assign(std::span<const VectorRecord>(tables_.vectors));
  draws_table_.assign(std::span<const DrawRecord>(tables_.draws));
  products_.reserve(tables_.product_count * sizeof(Product));
  cells_seen_.resize(residency.cells().size());
  draws_seen_.resize(residency.draws().size());
  group_shaded_.resize(residency.groups().size());
}

void Diffuse::collectCells(const streaming::Residency& residency, const lighting::GroupLights& lights) {
  project_work_.clear();
  samples_work_.clear();
  if (mode_seen_ == TransferMode::Unshadowed) return;
  for (std::uint32_t i = 0; i < tables_.cells.size(); ++i) {
    const streaming::ResidentCell& cell = residency.cells()[i];
    if (!cell.usable() || tables_.cells[i].vector_count == 0) continue;
    Seen& seen = cells_seen_[i];
    const std::uint64_t light = lights.versionOf(cell.group);
    if (seen.version == cell.version && seen.light == light) continue;
    seen = {.version = cell.version, .light = light, .cells = 0};
    ++group_shaded_[cell.group];
    project_work_.add({variantOf(tables_.cells[i].order), cell.block.page}, i, 1, 1);
    samples_work_.add({0, cell.block.page, residency.groups()[cell.group].samples.page}, i, cell.sample_count,
                      kWorkGroupSize);
  }
}

void Diffuse::collectDraws(const streaming::Residency& residency, const lighting::GroupLights& lights) {
  vertices_work_.clear();
  for (std::uint32_t i = 0; i < tables_.draws.size(); ++i) {
    const streaming::ResidentDraw& draw = residency.draws()[i];
    if (!draw.radiance) continue;
    Seen& seen = draws_seen_[i];
    const Seen now{
        .version = draw.version, .light = lights.versionOf(draw.group), .cells = group_shaded_[draw.group]};
    if (seen.version == now.version && seen.light == now.light && seen.cells == now.cells) continue;
    seen = now;
    const streaming::ResidentGroup& group = residency.groups()[draw.group];
    const streaming::ResidentMesh& mesh = residency.meshes()[draw.mesh];
    vertices_work_.add(
        {variantOf(group.order), draw.rows.page, mesh.block.page, group.samples.page, draw.radiance.page}, i,
        mesh.vertex_count, kWorkGroupSize);
  }
}

Result<const gpu::Program*> Diffuse::program(Stage stage, std::uint32_t order) {
  constexpr std::array<const char*, kStageCount> kFiles = {"diffuse_project.comp", "diffuse_samples.comp",
                                                           "diffuse_vertices.comp"};
  auto& programs = programs_[stage];
  if (const auto found = programs.find(order); found != programs.end()) return &found->second;
  std::vector<gpu::Define> defines;
  if (order != 0) defines.push_back({"LAMBENT_ORDER", std::to_string(order)});
  Result<gpu::Program> made = gpu::Program::create(fmt::format("{} order {}", kFiles[stage], order),
                                                   {{GL_COMPUTE_SHADER, kFiles[stage]}}, kShaders, defines);
  if (!made) return failAgain(made.error());
  return &programs.emplace(order, std::move(*made)).first->second;
}

Result<void> Diffuse::runCells(streaming::Residency& residency, const lighting::GroupLights& lights,
                               gpu::Counters& counters) {
  if (project_work_.empty()) return {};
  project_work_.upload(counters);
  samples_work_.upload(counters);
  lights.bindStorage(kBindLights);
  cells_table_.bindStorage(kBindCells);
  vectors_table_.bindStorage(kBindVectors);
  products_.bindStorage(kBindProducts);
  std::size_t index = 0;
  for (const auto& [key, items] : project_work_.batches()) {
    const Result<const gpu::Program*> kernel = program(Project, key[0]);
    if (!kernel) return failAgain(kernel.error());
    (*kernel)->use();
    residency.transfer().page(key[1]).bindStorage(kBindTransfer);
    project_work_.dispatch(index++, kBindWork, counters);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  index = 0;
  for (const auto& [key, items] : samples_work_.batches()) {
    const Result<const gpu::Program*> kernel = program(Samples, key[0]);
    if (!kernel) return failAgain(kernel.error());
    (*kernel)->use();
    residency.transfer().page(key[1]).bindStorage(kBindTransfer);
    residency.samples().page(key[2]).bindStorage(kBindSamples);
    samples_work_.dispatch(index++, kBindWork, counters);
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
    const Result<const gpu::Program*> kernel = program(Vertices, key[0]);
    if (!kernel) return failAgain(kernel.error());
    (*kernel)->use();
    // A page that no draw of the batch has anything in yet may not exist: any buffer will do in its place.
    const auto bind = [&](gpu::Arena& arena, std::uint32_t page, std::uint32_t binding) {
      if (page < arena.pageCount())
        arena.page(page).bindStorage(binding);
      else
        draws_table_.bindStorage(binding);
    };
    bind(residency.rows(), key[1], kBindRows);
    bind(residency.geometry(), key[2], kBindGeometry);
    bind(residency.samples(), key[3], kBindSamples);
    bind(residency.radiance(), key[4], kBindRadiance);
    vertices_work_.dispatch(index++, kBindWork, counters);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return {};
}

}  // namespace lambent::effects::diffuse
