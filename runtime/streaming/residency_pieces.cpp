// Uploads large items in pieces over several frames: meshes and codebooks here, textures in
// residency_images.cpp. An item is used once it is complete. An upload at once is the same with a single
// piece.
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <optional>

#include <glm/gtc/packing.hpp>

#include "runtime/streaming/residency.hpp"
#include "runtime/streaming/sizes.hpp"

namespace lambent::streaming {

namespace {

// Smallest piece of a frame, however small its budget is, so that large items are completed at all.
constexpr std::uint64_t kLeastBytes = std::uint64_t{64} << 10;
constexpr std::uint64_t kAll = ~std::uint64_t{0};

template <typename T>
std::span<const std::byte> bytesOf(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

// The attributes of a mesh, in the order of its block.
constexpr std::size_t kMeshParts = 7;
using MeshParts = std::array<std::span<const std::byte>, kMeshParts>;

MeshParts meshPartsOf(const bundle::MeshData& data, const std::vector<std::uint64_t>& colors) {
  return {bytesOf(data.positions), bytesOf(data.normals),  bytesOf(data.texcoords0), bytesOf(data.texcoords1),
          bytesOf(colors),         bytesOf(data.tangents), bytesOf(data.indices)};
}

// Makes a texture of E/pi with all mip levels, in which nothing is shaded yet.
gpu::Texture makeIrradiance(std::uint32_t side) {
  const auto levels = static_cast<std::uint32_t>(std::bit_width(side));
  gpu::Texture texture("irradiance", {.format = GL_RGBA16F, .width = side, .height = side, .levels = levels});
  for (std::uint32_t level = 0; level < levels; ++level)
    glClearTexImage(texture.id(), static_cast<GLint>(level), GL_RGBA, GL_FLOAT, nullptr);
  texture.interpolate(GL_LINEAR_MIPMAP_LINEAR);
  glTextureParameteri(texture.id(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  return texture;
}

std::uint64_t bytesOfParts(const MeshParts& parts) {
  std::uint64_t bytes = 0;
  for (const std::span<const std::byte> part : parts) bytes += part.size();
  return bytes;
}

}  // namespace

bool Residency::comesInPieces(const Ready& item) {
  return std::holds_alternative<ImageChunk>(item) || std::holds_alternative<MeshChunk>(item) ||
         std::holds_alternative<CodebookChunk>(item);
}

Residency::At Residency::at(const Whose& whose) {
  ResidentTables& tables = whose.staged ? staged_.at(whose.index) : tables_;
  return {tables, tables.bundles[whose.staged ? 0 : whose.index]};
}

Result<void> Residency::begin(std::uint32_t bundle, Ready item) {
  return begin(Whose{false, bundle}, std::move(item));
}

Result<void> Residency::beginStaged(Staged staged, Ready item) {
  return begin(Whose{true, staged}, std::move(item));
}

Result<std::uint64_t> Residency::proceed(std::uint32_t bundle, std::uint64_t max_bytes) {
  return proceed(Whose{false, bundle}, max_bytes);
}

Result<std::uint64_t> Residency::proceedStaged(Staged staged, std::uint64_t max_bytes) {
  return proceed(Whose{true, staged}, max_bytes);
}

void Residency::cancel(std::uint32_t bundle) {
  cancel(Whose{false, bundle});
}

Result<void> Residency::begin(const Whose& whose, Ready item) {
  assert(comesInPieces(item) && !coming_.contains(whose));
  const At into = at(whose);
  if (auto* image = std::get_if<ImageChunk>(&item)) {
    ImageUpload upload = begin(into.bundle, *image);
    upload.item = std::move(*image);
    coming_.emplace(whose, std::move(upload));
  } else if (auto* mesh = std::get_if<MeshChunk>(&item)) {
    Result<MeshUpload> upload = begin(std::move(*mesh));
    if (!upload) return failAgain(upload.error());
    coming_.emplace(whose, std::move(*upload));
  } else if (auto* codebook = std::get_if<CodebookChunk>(&item)) {
    if (Result<void> written = writeTables(into, *codebook); !written) return written;
    coming_.emplace(whose, CodebookUpload{std::move(*codebook)});
  }
  return {};
}

Result<std::uint64_t> Residency::proceed(const Whose& whose, std::uint64_t max_bytes) {
  const auto found = coming_.find(whose);
  if (found == coming_.end()) return 0;
  const At into = at(whose);
  max_bytes = std::max(max_bytes, kLeastBytes);
  std::uint64_t bytes = 0;
  Result<void> done;
  const auto whole = [&] {
    ++version_;
    return std::move(coming_.extract(found).mapped());
  };
  if (auto* image = std::get_if<ImageUpload>(&found->second)) {
    bytes = proceed(*image, max_bytes);
    if (image->rows_done == image->item.height) {
      auto upload = std::get<ImageUpload>(whole());
      finish(into.bundle, std::move(upload), upload.item.image);
    }
  } else if (auto* mesh = std::get_if<MeshUpload>(&found->second)) {
    bytes = proceed(*mesh, max_bytes);
    if (mesh->bytes_done == bytesOfParts(meshPartsOf(mesh->item.data, mesh->colors)))
      done = finish(into, std::get<MeshUpload>(whole()));
  } else if (auto* codebook = std::get_if<CodebookUpload>(&found->second)) {
    bytes = proceed(into, *codebook, max_bytes);
    if (codebook->bytes_done == bytesOf(codebook->item.codebook.vectors).size())
      finish(into, std::get<CodebookUpload>(whole()));
  }
  if (!done) return failAgain(done.error());
  return bytes;
}

void Residency::cancel(const Whose& whose) {
  const auto found = coming_.find(whose);
  if (found == coming_.end()) return;
  // Textures delete themselves, and cells own the blocks of codebooks.
  if (const auto* mesh = std::get_if<MeshUpload>(&found->second)) geometry_.release(mesh->block);
  coming_.erase(found);
}

// --- meshes ---

Result<Residency::MeshUpload> Residency::begin(MeshChunk item) {
  MeshUpload upload{.item = std::move(item), .colors = {}, .block = {}};
  upload.colors.reserve(upload.item.data.colors.size());
  for (const glm::vec4& color : upload.item.data.colors) upload.colors.push_back(glm::packUnorm4x16(color));
  const Result<gpu::Allocation> block =
      geometry_.allocate(bytesOfParts(meshPartsOf(upload.item.data, upload.colors)));
  if (!block) return failAgain(block.error());
  upload.block = *block;
  return upload;
}

std::uint64_t Residency::proceed(MeshUpload& upload, std::uint64_t max_bytes) {
  const std::uint64_t before = upload.bytes_done;
  std::uint64_t first = 0;  // offset of the part
  for (const std::span<const std::byte> part : meshPartsOf(upload.item.data, upload.colors)) {
    const std::uint64_t left = max_bytes - (upload.bytes_done - before);
    if (const std::uint64_t from = upload.bytes_done - first; left > 0 && from < part.size()) {
      const std::uint64_t count = std::min<std::uint64_t>(left, part.size() - from);
      geometry_.write(upload.block, upload.bytes_done, part.subspan(from, count));
      upload.bytes_done += count;
    }
    first += part.size();
    if (upload.bytes_done < first) break;
  }
  return upload.bytes_done - before;
}

Result<void> Residency::finish(At at, const MeshUpload& upload) {
  const MeshChunk& item = upload.item;
  const std::uint32_t index = at.bundle.first.meshes + at.bundle.first_primitive[item.mesh] + item.primitive;
  ResidentMesh& mesh = at.tables.meshes[index];
  assert(item.data.positions.size() == mesh.vertex_count && item.data.indices.size() == mesh.index_count);
  mesh.block = upload.block;
  mesh.mean_edge = item.mean_edge;
  const std::array<std::uint32_t*, kMeshParts> word_of = {
      &mesh.positions_word, &mesh.normals_word,  &mesh.texcoords_word[0], &mesh.texcoords_word[1],
      &mesh.colors_word,    &mesh.tangents_word, &mesh.indices_word};
  const MeshParts parts = meshPartsOf(item.data, upload.colors);
  std::uint64_t offset = 0;
  for (std::size_t i = 0; i < kMeshParts; ++i) {
    if (parts[i].empty()) continue;
    *word_of[i] = mesh.block.word() + static_cast<std::uint32_t>(offset / 4);
    offset += parts[i].size();
  }
  for (ResidentDraw& draw : at.tables.draws) {
    if (draw.mesh != index) continue;
    draw.version = version_;
    if (draw.glossy()) continue;
    const Result<gpu::Allocation> radiance =
        radiance_.allocate(4ull * vertexWords(draw.form(), draw.layered) * mesh.vertex_count);
    if (!radiance) return failAgain(radiance.error());
    draw.radiance = *radiance;
    if (draw.texels == 0) continue;
    draw.irradiance = makeIrradiance(draw.texels);
    at.bundle.texture_bytes += irradianceBytes(draw.texels);
  }
  return {};
}

Result<void> Residency::put(At at, MeshChunk item) {
  Result<MeshUpload> upload = begin(std::move(item));
  if (!upload) return failAgain(upload.error());
  proceed(*upload, kAll);
  return finish(at, *upload);
}

// --- codebooks ---

// Writes everything except the vectors, which are most of a codebook.
Result<void> Residency::writeTables(At at, const CodebookChunk& item) {
  ResidentCell& cell = cellOf(at.tables, at.bundle, item.group, item.cell);
  if (Result<void> reserved = reserveCell(cell); !reserved) return reserved;
  const ResidentTransfer& transfer = cell.transfers[item.transfer.value];
  const transfer::Codebook& codebook = item.codebook;
  assert(codebook.clusters() == transfer.clusters && codebook.axes.size() == transfer.axes &&
         item.positions.size() == cell.sample_count);
  std::vector<std::uint32_t> clusters;
  std::vector<transfer::AxisCode> weights;
  for (std::size_t c = 0, axis = 0; c < codebook.clusters(); ++c) {
    const std::uint32_t axes = codebook.axis_counts[c];
    clusters.insert(clusters.end(), {static_cast<std::uint32_t>(weights.size()), axes});
    weights.push_back({.offset = 1.0f, .scale = 0.0f});  // the mean has weight 1
    for (std::uint32_t j = 0; j < axes; ++j) weights.push_back(codebook.axes[axis++]);
  }
  const auto write = [&](std::uint32_t word, std::span<const std::byte> bytes) {
    transfer_.write(cell.block, 4ull * (word - cell.block.word()), bytes);
  };
  write(transfer.clusters_word, bytesOf(clusters));
  write(transfer.weights_word, bytesOf(weights));
  write(transfer.positions_word, bytesOf(item.positions));
  return {};
}

std::uint64_t Residency::proceed(At at, CodebookUpload& upload, std::uint64_t max_bytes) {
  const CodebookChunk& item = upload.item;
  const ResidentCell& cell = cellOf(at.tables, at.bundle, item.group, item.cell);
  const std::span<const std::byte> left = bytesOf(item.codebook.vectors).subspan(upload.bytes_done);
  const std::span<const std::byte> piece = left.first(std::min<std::uint64_t>(max_bytes, left.size()));
  const std::uint32_t first_word = cell.transfers[item.transfer.value].vectors_word - cell.block.word();
  transfer_.write(cell.block, 4ull * first_word + upload.bytes_done, piece);
  upload.bytes_done += piece.size();
  return piece.size();
}

void Residency::finish(At at, const CodebookUpload& upload) {
  ResidentCell& cell = cellOf(at.tables, at.bundle, upload.item.group, upload.item.cell);
  cell.transfers[upload.item.transfer.value].codebook_resident = true;
  cell.version = version_;
}

Result<void> Residency::put(At at, CodebookChunk item) {
  if (Result<void> written = writeTables(at, item); !written) return written;
  CodebookUpload upload{std::move(item)};
  proceed(at, upload, kAll);
  finish(at, upload);
  return {};
}

// Drops planes and transfer of groups from the GPU.
namespace {

ResidentGroup& groupOf(ResidentTables& tables, std::uint32_t bundle, bundle::GroupIndex group) {
  return tables.groups[tables.bundles[bundle].first.groups + group.value];
}

}  // namespace

void Residency::forgetShading(const ResidentGroup& group) {
  if (group.samples) samples_.clear(group.samples);
  for (std::uint32_t c = group.first_cell; c < group.first_cell + group.cell_count; ++c)
    tables_.cells[c].version = version_;
  for (ResidentDraw& draw : tables_.draws)
    if (&tables_.groups[draw.group] == &group) draw.version = version_;
}

void Residency::dropPlanes(std::uint32_t bundle, bundle::GroupIndex group, const PlanesToKeep& keep) {
  ++version_;
  const ResidentGroup& resident = groupOf(tables_, bundle, group);
  bool forget = false;
  for (std::uint32_t c = 0; c < resident.cell_count; ++c) {
    ResidentCell& cell = tables_.cells[resident.first_cell + c];
    const bool usable = cell.usable();
    for (std::uint32_t t = 0; t < cell.transfers.size(); ++t) {
      ResidentTransfer& transfer = cell.transfers[t];
      while (transfer.planes_resident > keep(bundle::CellIndex{c}, bundle::TransferIndex{t})) {
        ResidentPlane& plane = transfer.planes[--transfer.planes_resident];
        transfer_.release(plane.block);
        plane.block = {};
        cell.version = version_;
      }
    }
    forget |= usable && !cell.usable();
  }
  // A cell that is no longer usable is not shaded again, so its old samples must be cleared.
  if (forget) forgetShading(resident);
}

void Residency::dropTransfer(std::uint32_t bundle, bundle::GroupIndex group) {
  dropPlanes(bundle, group, [](bundle::CellIndex, bundle::TransferIndex) { return 0u; });
  const ResidentGroup& resident = groupOf(tables_, bundle, group);
  for (std::uint32_t c = 0; c < resident.cell_count; ++c) {
    ResidentCell& cell = tables_.cells[resident.first_cell + c];
    if (cell.block) transfer_.release(cell.block);
    cell.block = {};
    cell.light_weights_resident = cell.light_probes.size() == 1;
    for (ResidentTransfer& transfer : cell.transfers) transfer.codebook_resident = false;
  }
  forgetShading(resident);
}

}  // namespace lambent::streaming
