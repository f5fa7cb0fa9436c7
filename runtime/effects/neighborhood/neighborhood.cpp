#include "runtime/effects/neighborhood/neighborhood.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <numeric>
#include <string_view>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "lambent_effects_neighborhood_embedded.hpp"
#include "lambent_transfer_embedded.hpp"
#include "runtime/sh/rotation.hpp"

namespace lambent::effects::neighborhood {

constexpr gpu::FindText kNeighborhoodShaders[] = {&embedded::lambent_effects_neighborhood::find,
                                                  &embedded::lambent_transfer::find};

AtlasLayout layOutAtlas(std::span<const GridShape> shapes, std::uint32_t max_side) {
  AtlasLayout layout;
  layout.places.resize(shapes.size(), GridPlace{});
  std::vector<std::size_t> order(shapes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return shapes[a].size.y > shapes[b].size.y; });
  // Shelves run along y, each as high as its first grid; grids are placed side by side along z.
  std::uint32_t shelf_y = 0, shelf_height = 0, next_z = 0;
  for (const std::size_t i : order) {
    const GridShape& shape = shapes[i];
    if (glm::max(shape.size.x, glm::max(shape.size.y, shape.size.z)) > max_side || shape.outputs == 0)
      continue;
    const std::uint32_t per_column = std::min(shape.outputs, max_side / shape.size.z);
    const std::uint32_t columns = (shape.outputs + per_column - 1) / per_column;
    const std::uint64_t height = std::uint64_t{columns} * shape.size.y;
    const std::uint32_t depth = per_column * shape.size.z;
    std::uint32_t y = shelf_y, z = next_z;
    const bool new_shelf = height > shelf_height || next_z + std::uint64_t{depth} > max_side;
    if (new_shelf) {
      y = shelf_y + shelf_height;
      z = 0;
    }
    if (y + height > max_side) continue;
    if (new_shelf) {
      shelf_y = y;
      shelf_height = static_cast<std::uint32_t>(height);
    }
    next_z = z + depth;
    layout.places[i] = {.size_x = shape.size.x,
                        .size_y = shape.size.y,
                        .size_z = shape.size.z,
                        .outputs = shape.outputs,
                        .first_y = y,
                        .first_z = z,
                        .slabs_per_column = per_column,
                        .scale = 1.0f};
    layout.size =
        glm::max(layout.size, glm::uvec3(shape.size.x, y + static_cast<std::uint32_t>(height), next_z));
  }
  return layout;
}

static_assert(kWriteGroupsX == gpu::WorkList::kMaxGroupsX);

namespace {

gpu::Texture makeAtlas(const glm::uvec3& size) {
  gpu::Texture texture("neighborhoods",
                       {.format = GL_RGBA16F, .width = size.x, .height = size.y, .depth = size.z});
  texture.interpolate();
  constexpr float kNothing[] = {0.0f, 0.0f, 0.0f, 0.0f};
  glClearTexImage(texture.id(), 0, GL_RGBA, GL_FLOAT, kNothing);
  return texture;
}

template <typename Each>
void forCells(const streaming::Residency& residency, const Grid& grid, const Each& each) {
  const streaming::ResidentGroup& group = residency.groups()[grid.group];
  for (std::uint32_t c = group.first_cell; c < group.first_cell + group.cell_count; ++c)
    if (residency.cells()[c].domain == transfer::Domain::GridPoint) each(residency.cells()[c]);
}

// Returns whether all points have arrived that can improve the picture.
bool complete(const streaming::Residency& residency, const Grid& grid) {
  std::uint64_t points = 0;
  bool usable = true;
  forCells(residency, grid, [&](const streaming::ResidentCell& cell) {
    points += cell.sample_count;
    usable &= cell.usable();
  });
  const glm::uvec3& size = grid.points.size;
  return usable && points == std::uint64_t{size.x} * size.y * size.z;
}

// Returns a power of two near the group's light, so that half floats suit light of any strength.
float scaleOf(const lighting::GroupLights& lights, const streaming::ResidentGroup& group,
              std::uint32_t index) {
  float largest = 0.0f;
  const std::uint32_t end = lights.lampsOf(index) + group.light_columns;
  for (std::uint32_t i = lights.firstOf(index); i < end; ++i) {
    const glm::vec3 size = glm::abs(glm::vec3(lights.coefficients()[i]));
    largest = std::max({largest, size.r, size.g, size.b});
  }
  if (!(largest > 0.0f) || !std::isfinite(largest)) return 1.0f;
  return std::exp2(std::clamp(std::ceil(std::log2(largest)), -100.0f, 100.0f));
}

}  // namespace

Neighborhood::Neighborhood()
    : kernels_(kNeighborhoodShaders), writes_("neighborhood writes"), work_("neighborhood work") {}

void Neighborhood::setGrids(std::vector<Grid> grids, const streaming::Residency& residency) {
  const auto same = [](const Grid& a, const Grid& b) {
    return a.id == b.id && a.points.size == b.points.size && a.points.bounds_min == b.points.bounds_min &&
           a.points.bounds_max == b.points.bounds_max;
  };
  if (std::ranges::equal(grids, grids_, same)) {
    for (std::size_t i = 0; i < grids_.size(); ++i) grids_[i].group = grids[i].group;
    return;
  }
  std::swap(grids, grids_);
  written_versions_.assign(grids_.size(), 0);
  ++version_;
  std::vector<GridShape> shapes;
  for (const Grid& grid : grids_) {
    GridShape& shape = shapes.emplace_back(grid.points.size, 0);
    forCells(residency, grid, [&](const streaming::ResidentCell& cell) { shape.outputs = cell.outputs; });
  }
  GLint max_side = 0;
  glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &max_side);
  const AtlasLayout layout = layOutAtlas(shapes, static_cast<std::uint32_t>(max_side));
  for (std::size_t i = 0; i < grids_.size(); ++i) {
    grids_[i].place = layout.places[i];
    grids_[i].ready = false;
    for (const Grid& before : grids) {
      if (before.key != grids_[i].key || !before.ready || layout.places[i].outputs == 0) continue;
      grids_[i].ready = complete(residency, grids_[i]);
      grids_[i].place.scale = before.place.scale;
    }
  }
  atlas_size_ = layout.size;
  atlas_ = layout.size.x > 0 ? makeAtlas(layout.size) : gpu::Texture();
}

Result<void> Neighborhood::update(streaming::Residency& residency, const lighting::GroupLights& lights,
                                  const evaluate::Samples& samples, gpu::Counters& counters) {
  written_ = 0;
  records_.clear();
  work_.clear();
  for (std::size_t i = 0; i < grids_.size(); ++i) {
    Grid& grid = grids_[i];
    const std::uint64_t shaded = samples.matricesVersionOf(grid.group);
    if (grid.place.outputs == 0 || shaded == written_versions_[i]) continue;
    written_versions_[i] = shaded;
    ++written_;
    const bool ready = complete(residency, grid);
    const float scale = scaleOf(lights, residency.groups()[grid.group], grid.group);
    if (ready != grid.ready || scale != grid.place.scale) ++version_;
    grid.ready = ready;
    grid.place.scale = scale;
    const std::uint32_t page = residency.groups()[grid.group].samples.page;
    std::uint32_t first_point = 0;
    forCells(residency, grid, [&](const streaming::ResidentCell& cell) {
      records_.push_back({.grid = grid.place,
                          .first_output = cell.first_output,
                          .first_point = first_point,
                          .point_count = cell.sample_count,
                          .pad = 0});
      first_point += cell.sample_count;
      work_.add({page}, static_cast<std::uint32_t>(records_.size() - 1), cell.outputs * cell.sample_count,
                kWriteGroupSize);
    });
  }
  return work_.empty() ? Result<void>{} : write(residency, counters);
}

Result<void> Neighborhood::write(streaming::Residency& residency, gpu::Counters& counters) {
  writes_.assign(records_, counters);
  writes_.bindStorage(kBindWrites);
  glBindImageTexture(kImageAtlas, atlas_.id(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_RGBA16F);
  return evaluate::run(
      work_, counters,
      [&](const gpu::BatchKey& key) {
        residency.samples().page(key[0]).bindStorage(kBindWriteSamples);
        return kernels_.use("neighborhood_write.comp");
      },
      GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

namespace {

// The receivers of one dispatch, which share a kernel and pages.
struct Batch {
  std::uint32_t order = 0, transfer_page = 0, rows_page = 0, geometry_page = 0;
  auto operator<=>(const Batch&) const = default;
};

bool plain(const streaming::ResidentCell& cell) {
  return cell.domain == transfer::Domain::Vertex && cell.form() == transfer::Form::Vector;
}

std::span<const streaming::ResidentCell> cellsOf(const streaming::Residency& residency, std::uint32_t group) {
  const streaming::ResidentGroup& resident = residency.groups()[group];
  return std::span(residency.cells()).subspan(resident.first_cell, resident.cell_count);
}

std::uint64_t versionOf(const streaming::Residency& residency, std::uint32_t group) {
  std::uint64_t version = 0;
  for (const streaming::ResidentCell& cell : cellsOf(residency, group))
    version = std::max(version, cell.version);
  return version;
}

VertexArrival describe(const VertexDraw::From& from, const Grid& grid) {
  VertexArrival arrival{
      .grid_from_position = from.grid_from_position, .grid = grid.place, .turn = {}, .pad = {}};
  const int bands = static_cast<int>(transfer::bandsOf(grid.place.outputs));
  const sh::Rotation turn(glm::dquat(from.group_from_body), bands);
  std::size_t entry = 0;
  for (int l = 0; l < bands; ++l)
    for (int i = l * l; i < (l + 1) * (l + 1); ++i)
      for (int j = l * l; j < (l + 1) * (l + 1); ++j)
        arrival.turn[entry++] = static_cast<float>(turn.entry(i, j));
  return arrival;
}

GLuint groupsFor(std::uint32_t count) {
  return (count + kVertexGroupSize - 1) / kVertexGroupSize;
}

}  // namespace

bool hasTransfer(const streaming::Residency& residency, std::uint32_t index, std::uint32_t order) {
  const streaming::ResidentDraw& draw = residency.draws()[index];
  if (draw.form() != transfer::Form::Vector || !draw.rows || !draw.radiance) return false;
  std::optional<std::uint32_t> page;
  for (const streaming::ResidentCell& cell : cellsOf(residency, draw.group)) {
    if (!plain(cell)) continue;
    if (!cell.usable() || cell.transfers.front().shape.order != order || (page && *page != cell.block.page))
      return false;
    page = cell.block.page;
  }
  return page.has_value();
}

VertexReceivers::VertexReceivers()
    : kernels_(kNeighborhoodShaders),
      change_("radiance that bodies around change"),
      sample_places_("places of samples"),
      arrivals_("vertex arrivals"),
      transfers_("receivers' transfers"),
      planes_("receivers' planes"),
      block_("vertex receiver") {}

// Issues one dispatch for as many records as a block holds. `largest` is the largest number of elements of
// any record.
template <typename Record>
void VertexReceivers::dispatch(std::span<const Record> records, std::uint32_t largest,
                               gpu::Counters& counters) {
  for (std::size_t first = 0; first < records.size(); first += kRecordsPerDispatch) {
    std::array<Record, kRecordsPerDispatch> block{};
    const auto some =
        records.subspan(first, std::min<std::size_t>(kRecordsPerDispatch, records.size() - first));
    std::ranges::copy(some, block.begin());
    block_.assign(block);
    block_.bindUniform(kBindVertexBlock);
    glDispatchCompute(groupsFor(largest), static_cast<GLuint>(some.size()), 1);
    ++counters.dispatches;
    counters.uploaded_bytes += some.size_bytes();
  }
}

void VertexReceivers::layOut(const streaming::Residency& residency, std::span<const VertexDraw> draws) {
  const bool same = draws.size() == words_.size() && std::ranges::all_of(draws, [&](const VertexDraw& draw) {
                      return words_.contains(draw.draw);
                    });
  if (same) return;
  words_.clear();
  places_.clear();
  changed_.clear();
  std::uint32_t word = 0, place = 0;
  for (const VertexDraw& receiver : draws) {
    const streaming::ResidentDraw& draw = residency.draws()[receiver.draw];
    words_[receiver.draw] = word;
    word += 3 * residency.meshes()[draw.mesh].vertex_count;
    if (places_.contains(draw.group)) continue;
    places_[draw.group] = {.first = place, .version = 0};
    for (const streaming::ResidentCell& cell : cellsOf(residency, draw.group))
      if (plain(cell)) place += cell.sample_count;
  }
  change_.reserve(4 * std::size_t{word});
  sample_places_.reserve(4 * std::size_t{place});
}

// Plain cells come first in their group, so its samples are numbered as in the rows.
Result<void> VertexReceivers::findPlaces(streaming::Residency& residency, gpu::Counters& counters) {
  std::map<std::uint32_t, std::vector<PlacesCell>> batches;  // keyed by page
  for (auto& [group, places] : places_) {
    const std::uint64_t version = versionOf(residency, group);
    if (version == places.version) continue;
    places.version = version;
    std::uint32_t index = 0;
    for (const streaming::ResidentCell& cell : cellsOf(residency, group)) {
      const std::uint32_t local = index++;
      if (plain(cell))
        batches[cell.block.page].push_back({.positions_word = cell.transfers.front().positions_word,
                                            .sample_count = cell.sample_count,
                                            .first_place = places.first + cell.first_sample,
                                            .cell = local});
    }
  }
  if (batches.empty()) return {};
  if (Result<void> done = kernels_.use("neighborhood_places.comp"); !done) return done;
  sample_places_.bindStorage(kBindSamplePlaces);
  for (const auto& [page, cells] : batches) {
    residency.transfer().page(page).bindStorage(kBindVertexTransfer);
    const auto largest = std::ranges::max(cells, {}, &PlacesCell::sample_count).sample_count;
    dispatch(std::span<const PlacesCell>(cells), largest, counters);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return {};
}

bool VertexReceivers::changed(const streaming::Residency& residency, const Neighborhood& effect,
                              const VertexDraw& draw) {
  const streaming::ResidentDraw& resident = residency.draws()[draw.draw];
  std::vector<std::uint64_t> written;
  for (const VertexDraw::From& from : draw.from) written.push_back(effect.writtenVersion(from.grid));
  return changed_[draw.draw].renew(resident.version, versionOf(residency, resident.group), draw.from,
                                   written);
}

Result<void> VertexReceivers::update(streaming::Residency& residency, const lighting::GroupLights& lights,
                                     evaluate::TransferMode mode, const Neighborhood& effect,
                                     std::span<const VertexDraw> draws, gpu::Counters& counters) {
  shaded_ = 0;
  if (draws.empty() && words_.empty()) return {};
  if (structure_changed_.renew(residency.structureVersion())) {  // all indices have changed
    words_.clear();
    places_.clear();
    changed_.clear();
  }
  layOut(residency, draws);
  if (mode_changed_.renew(mode)) changed_.clear();
  std::vector<const VertexDraw*> dirty;
  for (const VertexDraw& draw : draws)
    if (changed(residency, effect, draw)) dirty.push_back(&draw);
  if (dirty.empty()) return {};
  if (Result<void> done = findPlaces(residency, counters); !done) return done;

  evaluate::TransferTable table;  // only its places of planes are used
  std::vector<transfer::TransferRecord> transfers;
  std::map<std::uint32_t, std::uint32_t> first_transfer;  // keyed by group
  std::vector<VertexArrival> arrivals;
  std::map<Batch, std::vector<VertexReceiver>> batches;
  for (const VertexDraw* draw : dirty) {
    const streaming::ResidentDraw& resident = residency.draws()[draw->draw];
    if (!first_transfer.contains(resident.group)) {
      first_transfer[resident.group] = static_cast<std::uint32_t>(transfers.size());
      for (const streaming::ResidentCell& cell : cellsOf(residency, resident.group)) {
        if (plain(cell)) table.add(cell, lights, mode);
        transfers.push_back(plain(cell) ? table.transfers[table.cells.back().first]
                                        : transfer::TransferRecord{});
      }
    }
    const streaming::ResidentMesh& mesh = residency.meshes()[resident.mesh];
    const Grid& grid = effect.grids()[draw->from.front().grid];
    const auto cells = cellsOf(residency, resident.group);
    const Batch batch{.order = transfer::bandsOf(grid.place.outputs),
                      .transfer_page = std::ranges::find_if(cells, plain)->block.page,
                      .rows_page = resident.rows.page,
                      .geometry_page = mesh.block.page};
    batches[batch].push_back({.first_arrival = static_cast<std::uint32_t>(arrivals.size()),
                              .arrival_count = static_cast<std::uint32_t>(draw->from.size()),
                              .vertex_count = mesh.vertex_count,
                              .positions_word = mesh.positions_word,
                              .rows_word = resident.rows.word(),
                              .row_entries = resident.row_entries,
                              .first_place = places_[resident.group].first,
                              .first_transfer = first_transfer[resident.group],
                              .change_word = words_[draw->draw],
                              .pad0 = 0,
                              .pad1 = 0,
                              .pad2 = 0});
    for (const VertexDraw::From& from : draw->from)
      arrivals.push_back(describe(from, effect.grids()[from.grid]));
  }
  arrivals_.assign(arrivals, counters);
  transfers_.assign(transfers, counters);
  planes_.assign(table.places, counters);
  effect.bind();
  arrivals_.bindStorage(kBindVertexArrivals);
  transfers_.bindStorage(kBindVertexTransfers);
  planes_.bindStorage(kBindVertexPlanes);
  sample_places_.bindStorage(kBindSamplePlaces);
  change_.bindStorage(kBindVertexChange);
  for (const auto& [batch, receivers] : batches) {
    if (Result<void> done =
            kernels_.use("neighborhood_vertices.comp", {{"LAMBENT_ORDER", fmt::format("{}u", batch.order)}});
        !done)
      return done;
    residency.transfer().page(batch.transfer_page).bindStorage(kBindVertexTransfer);
    residency.rows().page(batch.rows_page).bindStorage(kBindVertexRows);
    residency.geometry().page(batch.geometry_page).bindStorage(kBindVertexGeometry);
    const auto largest = std::ranges::max(receivers, {}, &VertexReceiver::vertex_count).vertex_count;
    dispatch(std::span<const VertexReceiver>(receivers), largest, counters);
  }
  shaded_ = static_cast<std::uint32_t>(dirty.size());
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return {};
}

}  // namespace lambent::effects::neighborhood
