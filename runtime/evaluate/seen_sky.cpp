#include "runtime/evaluate/seen_sky.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "runtime/evaluate/transfer_table.hpp"
#include "runtime/lighting/seen_kernel.hpp"

namespace lambent::evaluate {

namespace {

// Returns how much of a group's transfer has arrived, as a number that changes when it pays to look again:
// when a cell becomes usable, and when it is complete.
std::uint64_t arrivedOf(const streaming::Residency& residency, const streaming::ResidentGroup& group) {
  std::uint64_t arrived = 0;
  for (std::uint32_t c = group.first_cell; c < group.first_cell + group.cell_count; ++c) {
    const streaming::ResidentCell& cell = residency.cells()[c];
    if (cell.domain != transfer::Domain::Vertex || cell.matrices() || !cell.usable()) continue;
    const bool whole = std::ranges::all_of(cell.transfers, [](const streaming::ResidentTransfer& transfer) {
      return transfer.planes_resident == transfer.planes.size();
    });
    arrived += whole ? 2 : 1;
  }
  return arrived;
}

gpu::Texture kernelTexture() {
  const lighting::SeenKernel kernel = lighting::makeSeenKernel();
  gpu::Texture texture("seen sky kernel", {.format = GL_RGBA32F,
                                           .width = lighting::kSeenCosines,
                                           .height = lighting::kSeenRoughnesses,
                                           .layers = lighting::kSeenLayers});
  glTextureSubImage3D(texture.id(), 0, 0, 0, 0, lighting::kSeenCosines, lighting::kSeenRoughnesses,
                      lighting::kSeenLayers, GL_RGBA, GL_FLOAT, kernel.texels.data());
  texture.interpolate();
  return texture;
}

std::uint32_t wordsOf(std::uint32_t outputs) {
  return transfer::kSeenWords * outputs;
}

// Returns the record of a draw whose group's samples begin at word 0.
SeenDraw recordOf(const streaming::ResidentDraw& draw, const streaming::ResidentGroup& group,
                  const streaming::ResidentMesh& mesh) {
  const streaming::SampleStretch stretch = group.stretchOf(draw.form());
  SeenDraw record{.group_from_mesh_normal = {},
                  .vertex_count = mesh.vertex_count,
                  .normals_word = mesh.normals_word,
                  .rows_word = draw.rows.word(),
                  .row_entries = draw.row_entries,
                  .first_sample = stretch.first_sample,
                  .samples_word = wordsOf(1) * stretch.first_sample,
                  .seen_word = draw.seenWord(mesh),
                  .pad = 0};
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      record.group_from_mesh_normal[4 * column + row] = draw.group_from_mesh_normal[column][row];
  return record;
}

}  // namespace

// The tables that the kernels read. Samples of all groups with draws to write lie one after the other: those
// with one output, then the normal-mapped ones.
struct SeenSky::Tables {
  TransferTable transfers;
  std::vector<SeenCell> cells;
  std::vector<SeenDraw> draws;
  std::uint64_t words = 0;  // of all samples
};

SeenSky::SeenSky()
    : cells_("seen sky cells"),
      transfers_("seen sky transfers"),
      places_("seen sky places"),
      draws_("seen sky draws"),
      samples_work_("seen sky samples work"),
      vertices_work_("seen sky vertices work") {}

void SeenSky::bindKernel(GLuint unit) const {
  kernel_.bind(unit);
  glBindSampler(unit, 0);  // the texture's own sampling is used
}

Result<void> SeenSky::update(streaming::Residency& residency, const lighting::GroupLights& lights,
                             gpu::Counters& counters) {
  if (!residency_changed_.renew(residency.version())) return {};
  if (draws_changed_.follow(residency.draws(), &streaming::ResidentDraw::id)) ++version_;
  if (!collect(residency)) return {};
  if (!kernel_) kernel_ = kernelTexture();
  const Tables tables = describe(residency, lights);
  cells_.assign(std::span<const SeenCell>(tables.cells));
  transfers_.assign(std::span<const transfer::TransferRecord>(tables.transfers.transfers));
  places_.assign(std::span<const std::uint32_t>(tables.transfers.places));
  draws_.assign(std::span<const SeenDraw>(tables.draws));
  const gpu::Buffer samples("seen sky samples", 4 * tables.words, gpu::WrittenBy::Gpu);
  glClearNamedBufferData(samples.id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  samples.bindStorage(kBindSeenSamples);
  ++version_;
  return run(residency, counters);
}

bool SeenSky::collect(const streaming::Residency& residency) {
  due_.clear();
  for (std::uint32_t i = 0; i < residency.draws().size(); ++i) {
    const streaming::ResidentDraw& draw = residency.draws()[i];
    if (!draw.layered || !draw.radiance || !draw.rows) continue;
    const std::uint64_t arrived = arrivedOf(residency, residency.groups()[draw.group]);
    if (arrived > 0 && draws_changed_[i].renew(draw.version, arrived)) due_.push_back(i);
  }
  return !due_.empty();
}

SeenSky::Tables SeenSky::describe(const streaming::Residency& residency,
                                  const lighting::GroupLights& lights) {
  Tables tables;
  samples_work_.clear();
  vertices_work_.clear();
  std::set<std::uint32_t> groups;
  for (const std::uint32_t i : due_) groups.insert(residency.draws()[i].group);
  std::map<std::uint32_t, std::uint32_t> word_of;  // of each group's first sample
  for (const std::uint32_t g : groups) {
    const streaming::ResidentGroup& group = residency.groups()[g];
    word_of[g] = static_cast<std::uint32_t>(tables.words);
    for (std::uint32_t c = group.first_cell; c < group.first_cell + group.cell_count; ++c) {
      const streaming::ResidentCell& cell = residency.cells()[c];
      if (cell.domain != transfer::Domain::Vertex || cell.matrices()) continue;
      const auto first_word = static_cast<std::uint32_t>(tables.words);
      tables.words += std::uint64_t{wordsOf(cell.outputs)} * cell.sample_count;
      tables.transfers.add(cell, lights, TransferMode::Shadowed);
      const TransferTable::Cell range = tables.transfers.cells.back();
      for (std::uint32_t t = range.first; cell.usable() && t < range.first + range.count; ++t) {
        if (tables.transfers.transfers[t].order == 0) continue;  // the group's own lights
        samples_work_.add({cell.outputs, cell.block.page}, static_cast<std::uint32_t>(tables.cells.size()),
                          cell.sample_count, transfer::kWorkGroupSize);
        tables.cells.push_back({.transfer = t, .first_word = first_word});
      }
    }
  }
  for (const std::uint32_t i : due_) {
    const streaming::ResidentDraw& draw = residency.draws()[i];
    const streaming::ResidentGroup& group = residency.groups()[draw.group];
    const streaming::ResidentMesh& mesh = residency.meshes()[draw.mesh];
    SeenDraw record = recordOf(draw, group, mesh);
    record.samples_word += word_of[draw.group];
    vertices_work_.add({draw.outputs, draw.rows.page, mesh.block.page, draw.radiance.page},
                       static_cast<std::uint32_t>(tables.draws.size()), mesh.vertex_count,
                       transfer::kWorkGroupSize);
    tables.draws.push_back(record);
  }
  return tables;
}

Result<const gpu::Program*> SeenSky::program(const char* file, std::uint32_t outputs) {
  const std::pair<std::string, std::uint32_t> variant(file, outputs);
  if (const auto found = programs_.find(variant); found != programs_.end()) return &found->second;
  const std::vector<gpu::Define> defines = {{"LAMBENT_OUTPUTS", std::to_string(outputs)}};
  Result<gpu::Program> made = gpu::Program::create(fmt::format("{} outputs {}", file, outputs),
                                                   {{GL_COMPUTE_SHADER, file}}, kEvaluateShaders, defines);
  if (!made) return failAgain(made.error());
  return &programs_.emplace(variant, std::move(*made)).first->second;
}

Result<void> SeenSky::run(streaming::Residency& residency, gpu::Counters& counters) {
  cells_.bindStorage(kBindSeenCells);
  transfers_.bindStorage(transfer::kBindTransfers);
  places_.bindStorage(transfer::kBindPlaces);
  samples_work_.upload(counters);
  std::size_t index = 0;
  for (const auto& [key, items] : samples_work_.batches()) {
    const Result<const gpu::Program*> kernel = program("seen_sky_samples.comp", key[0]);
    if (!kernel) return failAgain(kernel.error());
    (*kernel)->use();
    residency.transfer().page(key[1]).bindStorage(transfer::kBindTransfer);
    samples_work_.dispatch(index++, transfer::kBindWork, counters);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  draws_.bindStorage(kBindSeenDraws);
  vertices_work_.upload(counters);
  index = 0;
  for (const auto& [key, items] : vertices_work_.batches()) {
    const Result<const gpu::Program*> kernel = program("seen_sky_vertices.comp", key[0]);
    if (!kernel) return failAgain(kernel.error());
    (*kernel)->use();
    residency.rows().page(key[1]).bindStorage(kBindSeenRows);
    residency.geometry().page(key[2]).bindStorage(kBindSeenGeometry);
    residency.radiance().page(key[3]).bindStorage(kBindSeenVertices);
    vertices_work_.dispatch(index++, transfer::kBindWork, counters);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return {};
}

}  // namespace lambent::evaluate
