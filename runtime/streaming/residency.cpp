#include "runtime/streaming/residency.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "runtime/streaming/resident_tables.hpp"

namespace lambent::streaming {

namespace {

// Smallest size of a page, which small bundles share.
constexpr std::uint64_t kMinPageBytes = std::uint64_t{1} << 20;

// Lays out a cell without its planes from `word` on. Returns the first word after it.
std::uint32_t layOut(ResidentCell& cell, std::uint32_t word) {
  if (cell.light_probes.size() > 1) {
    cell.light_weights_word = word;
    word += kLightWeightWords * cell.sample_count;
  }
  for (ResidentTransfer& transfer : cell.transfers) {
    const std::uint32_t vectors = transfer.clusters + transfer.axes;
    transfer.clusters_word = word;
    transfer.weights_word = transfer.clusters_word + 2 * transfer.clusters;
    transfer.vectors_word = transfer.weights_word + 2 * vectors;
    transfer.positions_word = transfer.vectors_word + vectors * transfer.shape.size();
    word = transfer.positions_word + cell.sample_count;
  }
  return word;
}

// Returns the size of a cell with all planes.
std::uint64_t wholeBytes(ResidentCell cell) {
  constexpr std::uint64_t kBlock = gpu::Arena::kAlignment;
  std::uint64_t bytes = (4ull * layOut(cell, 0) + kBlock - 1) / kBlock * kBlock;
  for (const ResidentTransfer& transfer : cell.transfers)
    for (const ResidentPlane& plane : transfer.planes) bytes += planeBytes(plane);
  return bytes;
}

// Makes a density texture that is linear between voxel centres and constant in the outermost half voxel. It
// has 16 bits even for codes of 8 bits, because some devices interpolate 8-bit texels with a precision of 8
// bits.
gpu::Texture makeDensityTexture(const bundle::VolumeGrid& grid, const std::vector<std::byte>& codes) {
  gpu::Texture texture("density",
                       {.format = GL_R16, .width = grid.size.x, .height = grid.size.y, .depth = grid.size.z});
  std::vector<std::uint16_t> words(codes.size() * 8 / grid.bits);
  if (grid.bits == 16)
    std::memcpy(words.data(), codes.data(), codes.size());
  else
    std::transform(codes.begin(), codes.end(), words.begin(), [](std::byte code) {
      return static_cast<std::uint16_t>(257 * std::to_integer<unsigned>(code));  // 255 becomes 65535
    });
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTextureSubImage3D(texture.id(), 0, 0, 0, 0, static_cast<GLsizei>(grid.size.x),
                      static_cast<GLsizei>(grid.size.y), static_cast<GLsizei>(grid.size.z), GL_RED,
                      GL_UNSIGNED_SHORT, words.data());
  texture.interpolate();
  return texture;
}

ResidentVolume& volumeOf(ResidentTables& tables, const ResidentBundle& bundle, bundle::GroupIndex group) {
  return tables.volumes[static_cast<std::size_t>(tables.groups[bundle.first.groups + group.value].volume)];
}

}  // namespace

Residency::Residency(std::uint64_t max_page_bytes)
    : max_page_bytes_(max_page_bytes),
      geometry_("geometry", gpu::Arena::kMaxPageBytes, staging_),
      transfer_("transfer", gpu::Arena::kMaxPageBytes, staging_),
      samples_("samples", gpu::Arena::kMaxPageBytes, staging_),
      rows_("rows", gpu::Arena::kMaxPageBytes, staging_),
      radiance_("radiance", gpu::Arena::kMaxPageBytes, staging_) {}

Result<ResidentTables> Residency::make(const bundle::Description& description) {
  const Needs needs = needsOf(description);
  const auto page_bytes = [&](std::uint64_t need) {
    return std::min(std::max(need, kMinPageBytes), max_page_bytes_);
  };
  geometry_.setPageBytes(page_bytes(needs.geometry));
  transfer_.setPageBytes(page_bytes(needs.transfer));
  samples_.setPageBytes(page_bytes(needs.samples));
  rows_.setPageBytes(page_bytes(needs.rows));
  radiance_.setPageBytes(page_bytes(needs.radiance));
  ResidentTables tables = tablesOf(description, ++version_, next_id_);
  for (ResidentGroup& group : tables.groups) {
    const std::uint64_t sample_count = samplesOf(description.groups[group.index.value]);
    if (sample_count == 0) continue;
    const Result<gpu::Allocation> samples = samples_.allocate(16 * sample_count);
    if (!samples) {
      release(tables);
      return failAgain(samples.error());
    }
    group.samples = *samples;
    samples_.clear(*samples);
    for (std::uint32_t c = 0; c < group.cell_count; ++c)
      tables.cells[group.first_cell + c].first_output += group.samples.word() / 4;
  }
  return tables;
}

void Residency::release(const ResidentTables& tables) {
  const auto give_back = [](gpu::Arena& arena, const gpu::Allocation& block) {
    if (block) arena.release(block);
  };
  for (const ResidentMesh& mesh : tables.meshes) give_back(geometry_, mesh.block);
  for (const ResidentGroup& group : tables.groups) give_back(samples_, group.samples);
  for (const ResidentCell& cell : tables.cells) {
    give_back(transfer_, cell.block);
    for (const ResidentTransfer& transfer : cell.transfers)
      for (const ResidentPlane& plane : transfer.planes) give_back(transfer_, plane.block);
  }
  for (const ResidentDraw& draw : tables.draws) {
    give_back(rows_, draw.rows);
    give_back(rows_, draw.texel_rows);
    give_back(radiance_, draw.radiance);
  }
}

void Residency::structureChanged() {
  ++version_;
  ++structure_version_;
  ++proxies_version_;
}

Result<void> Residency::add(const bundle::Description& description, std::uint32_t slot) {
  Result<ResidentTables> made = make(description);
  if (!made) return failAgain(made.error());
  insert(tables_, slot, std::move(*made));
  structureChanged();
  return {};
}

void Residency::remove(std::uint32_t slot) {
  cancel(slot);
  release(extract(tables_, slot));
  structureChanged();
}

Result<Residency::Place> Residency::stage(const bundle::Description& description) {
  Result<ResidentTables> made = make(description);
  if (!made) return failAgain(made.error());
  staged_.emplace(next_staged_, std::move(*made));
  return Place(/*is_staged=*/true, next_staged_++);
}

void Residency::discard(const Place& staged) {
  cancel(staged);
  release(staged_.at(staged.index));
  staged_.erase(staged.index);
}

void Residency::show(const Place& staged, std::uint32_t slot) {
  assert(!comes(staged));
  cancel(slot);
  const ResidentTables old = present(slot) ? extract(tables_, slot) : ResidentTables{};
  insert(tables_, slot, std::move(staged_.at(staged.index)));
  staged_.erase(staged.index);
  release(old);
  structureChanged();
}

Residency::At Residency::at(const Place& place) {
  assert(place.staged || present(place.index));
  ResidentTables& tables = place.staged ? staged_.at(place.index) : tables_;
  return {tables, tables.bundles[place.staged ? 0 : place.index]};
}

Result<void> Residency::upload(const Place& place, Ready item) {
  const At into = at(place);
  ++version_;
  if (!place.staged && std::holds_alternative<ProxyChunk>(item)) ++proxies_version_;
  if (comesInPieces(item)) {
    Result<Upload> made = makeUpload(into, std::move(item));
    if (!made) return failAgain(made.error());
    proceed(into, *made, ~std::uint64_t{0});
    return finish(into, std::move(*made));
  }
  return std::visit(
      [&](const auto& ready) -> Result<void> {
        if constexpr (requires { this->put(into, ready); }) return put(into, ready);
        return {};
      },
      item);
}

Result<void> Residency::put(At at, const WeightsChunk& item) {
  ResidentDraw& draw = at.tables.draws[at.bundle.first.draws + item.draw];
  const transfer::VertexWeights& rows = item.rows;
  const std::size_t vertices = at.tables.meshes[draw.mesh].vertex_count;
  assert(rows.offsets.size() == vertices + draw.texels * draw.texels + 1u);
  const std::size_t entries = rows.offsets[vertices];
  const auto offsets = std::span(rows.offsets).first(vertices + 1);
  const auto samples = std::span(rows.samples).first(entries),
             of_texels = std::span(rows.samples).subspan(entries);
  std::vector<std::uint16_t> weights(entries);
  // This rounds to nearest in a loop that compilers vectorize, unlike glm::packUnorm1x16.
  std::transform(rows.weights.begin(), rows.weights.begin() + static_cast<std::ptrdiff_t>(entries),
                 weights.begin(), [](float weight) {
                   return static_cast<std::uint16_t>(std::clamp(weight, 0.0f, 1.0f) * 65535.0f + 0.5f);
                 });
  const std::uint64_t samples_at = 4ull * offsets.size(), weights_at = samples_at + 4ull * entries;
  const Result<gpu::Allocation> block = rows_.allocate(weights_at + 2 * entries);
  if (!block) return failAgain(block.error());
  rows_.write(*block, 0, std::as_bytes(offsets));
  rows_.write(*block, samples_at, std::as_bytes(samples));
  rows_.write(*block, weights_at, std::as_bytes(std::span(weights)));
  draw.rows = *block;
  draw.row_entries = static_cast<std::uint32_t>(entries);
  draw.version = version_;
  if (of_texels.empty()) return {};
  const Result<gpu::Allocation> texels = rows_.allocate(of_texels.size_bytes());
  if (!texels) return failAgain(texels.error());
  rows_.write(*texels, 0, std::as_bytes(of_texels));
  draw.texel_rows = *texels;
  return {};
}

Result<void> Residency::reserveCell(ResidentCell& cell) {
  if (cell.block) return {};
  const Result<gpu::Allocation> block = transfer_.allocate(4ull * layOut(cell, 0), wholeBytes(cell));
  if (!block) return failAgain(block.error());
  cell.block = *block;
  layOut(cell, block->word());
  return {};
}

Result<void> Residency::moveCell(ResidentCell& cell) {
  const Result<gpu::Allocation> block = transfer_.allocate(cell.block.byte_count, wholeBytes(cell));
  if (!block) return failAgain(block.error());
  const auto move = [&](gpu::Allocation& from, const gpu::Allocation& to) {
    transfer_.copy(from, to);
    transfer_.release(from);
    from = to;
  };
  move(cell.block, *block);
  layOut(cell, cell.block.word());
  for (ResidentTransfer& transfer : cell.transfers)
    for (ResidentPlane& plane : transfer.planes) {
      if (plane.block) move(plane.block, *transfer_.allocateIn(cell.block.page, planeBytes(plane)));
    }
  return {};
}

Result<void> Residency::put(At at, const PlaneChunk& item) {
  ResidentCell& cell = cellOf(at.tables, at.bundle, item.group, item.cell);
  if (Result<void> reserved = reserveCell(cell); !reserved) return reserved;
  ResidentTransfer& transfer = cell.transfers[item.transfer.value];
  // The loader delivers the planes of a cell in order, so the loaded planes are always the first ones.
  assert(item.plane.value == transfer.planes_resident);
  ResidentPlane& plane = transfer.planes[item.plane.value];
  std::optional<gpu::Allocation> block = transfer_.allocateIn(cell.block.page, planeBytes(plane));
  if (!block) {  // other cells have filled the page
    if (Result<void> moved = moveCell(cell); !moved) return moved;
    block = transfer_.allocateIn(cell.block.page, planeBytes(plane));
  }
  plane.block = *block;
  transfer_.write(plane.block, 0, item.codes);
  transfer.planes_resident = item.plane.value + 1;
  cell.version = version_;
  return {};
}

Result<void> Residency::put(At at, const LightWeightsChunk& item) {
  ResidentCell& cell = cellOf(at.tables, at.bundle, item.group, item.cell);
  if (Result<void> reserved = reserveCell(cell); !reserved) return reserved;
  assert(item.samples.size() == cell.sample_count && cell.light_probes.size() > 1);
  static_assert(sizeof(transfer::LightWeights) == 4 * kLightWeightWords);
  transfer_.write(cell.block, 4ull * (cell.light_weights_word - cell.block.word()),
                  std::as_bytes(std::span(item.samples)));
  cell.light_weights_resident = true;
  cell.version = version_;
  return {};
}

Result<void> Residency::put(At at, const ProxyChunk& item) {
  at.tables.groups[at.bundle.first.groups + item.group.value].proxy = item.proxy;
  return {};
}

Result<void> Residency::put(At at, const BrdfChunk& item) {
  Result<BrdfTexture> made =
      makeBrdfTexture(item.data, item.texels, fmt::format("BRDF table {}", item.table));
  if (!made) return failAgain(made.error());
  at.bundle.brdf_tables[item.table] = std::move(*made);
  at.bundle.texture_bytes += item.texels.bytes();
  return {};
}

Result<void> Residency::put(At at, const DensityChunk& item) {
  ResidentVolume& volume = volumeOf(at.tables, at.bundle, item.group);
  volume.density = makeDensityTexture(volume.grid, item.codes);
  volume.block_maxima = item.block_maxima;
  volume.version = version_;
  at.bundle.texture_bytes += densityBytes(volume.grid.size);
  return {};
}

Result<void> Residency::put(At at, const VoxelsChunk& item) {
  ResidentVolume& volume = volumeOf(at.tables, at.bundle, item.group);
  assert(item.voxels.size() == volume.sample_count);
  const std::span<const std::byte> bytes = std::as_bytes(std::span(item.voxels));
  volume.voxels = gpu::Buffer("voxels", std::max<std::size_t>(bytes.size(), 4));
  volume.voxels.writeBytes(0, bytes);
  volume.version = version_;
  at.bundle.texture_bytes += bytes.size();
  return {};
}

void Residency::forgetShading() {
  ++version_;
  for (ResidentCell& cell : tables_.cells) cell.version = version_;
  for (ResidentDraw& draw : tables_.draws) draw.version = version_;
}

std::uint64_t Residency::bytesResident() const {
  std::uint64_t bytes = 0;
  for (const gpu::Arena* arena : arenas()) bytes += arena->bytesUsed();
  for (const ResidentBundle& bundle : tables_.bundles) bytes += bundle.texture_bytes;
  for (const auto& [staged, tables] : staged_) bytes += tables.bundles.front().texture_bytes;
  for (const auto& [place, upload] : coming_)
    bytes += bytesOfTexture(upload.color) + bytesOfTexture(upload.linear);
  return bytes;
}

}  // namespace lambent::streaming
