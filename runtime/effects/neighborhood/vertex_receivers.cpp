#include "runtime/effects/neighborhood/vertex_receivers.hpp"

#include <algorithm>
#include <array>
#include <compare>

#include <fmt/format.h>

#include "runtime/effects/neighborhood/neighborhood.hpp"
#include "runtime/sh/rotation.hpp"

namespace lambent::effects::neighborhood {

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
    : change_("radiance that bodies around change"),
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
    block_.assign(std::span<const Record>(block));
    glBindBufferBase(GL_UNIFORM_BUFFER, kBindVertexBlock, block_.buffer().id());
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
  arrivals_.assign(std::span<const VertexArrival>(arrivals));
  transfers_.assign(std::span<const transfer::TransferRecord>(transfers));
  planes_.assign(std::span<const std::uint32_t>(table.places));
  counters.uploaded_bytes += arrivals.size() * sizeof(VertexArrival) +
                             transfers.size() * sizeof(transfer::TransferRecord) + 4 * table.places.size();
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
