// Uploads large items in pieces over several frames, which are used once they are complete. Drops finer
// levels of textures, planes and transfer.
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>

#include <fmt/format.h>
#include <glm/gtc/packing.hpp>

#include "runtime/streaming/residency.hpp"
#include "runtime/streaming/textures.hpp"

namespace lambent::streaming {

namespace {

// Smallest piece of a frame, however small its budget is, so that large items are completed at all.
constexpr std::uint64_t kLeastBytes = std::uint64_t{64} << 10;

template <typename T>
std::span<const std::byte> partOf(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

// Returns a copy of the texture from its level `from` on.
gpu::Texture coarser(const gpu::Texture& texture, std::uint32_t from, const std::string& label) {
  const gpu::TextureDesc& desc = texture.desc();
  const ImageSize size = sizeAt({desc.width, desc.height}, from);
  gpu::Texture result(
      label,
      {.format = desc.format, .width = size.width, .height = size.height, .levels = desc.levels - from});
  for (std::uint32_t level = 0; level < desc.levels - from; ++level) {
    const ImageSize here = sizeAt(size, level);
    glCopyImageSubData(texture.id(), GL_TEXTURE_2D, static_cast<GLint>(from + level), 0, 0, 0, result.id(),
                       GL_TEXTURE_2D, static_cast<GLint>(level), 0, 0, 0, static_cast<GLsizei>(here.width),
                       static_cast<GLsizei>(here.height), 1);
  }
  return result;
}

void writeRows(const gpu::Texture& texture, std::uint32_t first, std::span<const std::byte> rgba) {
  const std::uint32_t width = texture.desc().width;
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTextureSubImage2D(texture.id(), 0, 0, static_cast<GLint>(first), static_cast<GLsizei>(width),
                      static_cast<GLsizei>(rgba.size() / (std::size_t{4} * width)), GL_RGBA, GL_UNSIGNED_BYTE,
                      rgba.data());
}

std::string labelOf(std::uint32_t image) {
  return fmt::format("image {}", image);
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

ResidentGroup& groupOf(ResidentTables& tables, std::uint32_t bundle, bundle::GroupIndex group) {
  return tables.groups[tables.bundles[bundle].first.groups + group.value];
}

}  // namespace

std::uint64_t Residency::bytesOfTexture(const gpu::Texture& texture) {
  return texture ? textureBytes({texture.desc().width, texture.desc().height}) : 0;
}

bool Residency::comesInPieces(const Ready& item) {
  return std::holds_alternative<ImageChunk>(item) || std::holds_alternative<MeshChunk>(item) ||
         std::holds_alternative<CodebookChunk>(item);
}

Result<void> Residency::begin(const Place& place, Ready item) {
  assert(comesInPieces(item) && !coming_.contains(place));
  Result<Upload> made = makeUpload(at(place), std::move(item));
  if (!made) return failAgain(made.error());
  coming_.emplace(place, std::move(*made));
  return {};
}

Result<std::uint64_t> Residency::proceed(const Place& place, std::uint64_t max_bytes) {
  const auto found = coming_.find(place);
  if (found == coming_.end()) return 0;
  const At into = at(place);
  const std::uint64_t bytes = proceed(into, found->second, std::max(max_bytes, kLeastBytes));
  if (!found->second.whole()) return bytes;
  ++version_;
  if (Result<void> done = finish(into, std::move(coming_.extract(found).mapped())); !done)
    return failAgain(done.error());
  return bytes;
}

void Residency::cancel(const Place& place) {
  const auto found = coming_.find(place);
  if (found == coming_.end()) return;
  // Textures delete themselves, and cells own the blocks of codebooks.
  if (found->second.block) geometry_.release(found->second.block);
  coming_.erase(found);
}

Result<Residency::Upload> Residency::makeUpload(At at, Ready item) {
  Upload upload{.item = std::move(item), .colors = {}, .block = {}, .color = {}, .linear = {}, .parts = {}};
  if (const auto* image = std::get_if<ImageChunk>(&upload.item)) {
    const ImageUse use = at.bundle.image_uses[image->image];
    const auto make = [&](const std::string& label, GLenum format) {
      return gpu::Texture(label, {.format = format,
                                  .width = image->width,
                                  .height = image->height,
                                  .levels = levelCount({image->width, image->height})});
    };
    upload.granule = std::uint64_t{4} * image->width;
    if (use.color) {
      upload.color = make(labelOf(image->image), GL_SRGB8_ALPHA8);
      upload.parts.push_back(partOf(image->rgba));
    }
    if (use.linear) {
      upload.linear = make(labelOf(image->image) + " linear", GL_RGBA8);
      upload.parts.push_back(partOf(image->linear.empty() ? image->rgba : image->linear));
    }
  } else if (const auto* mesh = std::get_if<MeshChunk>(&upload.item)) {
    const bundle::MeshData& data = mesh->data;
    upload.colors.reserve(data.colors.size());
    for (const glm::vec4& color : data.colors) upload.colors.push_back(glm::packUnorm4x16(color));
    upload.parts = {partOf(data.positions),  partOf(data.normals),  partOf(data.texcoords0),
                    partOf(data.texcoords1), partOf(upload.colors), partOf(data.tangents),
                    partOf(data.indices)};
    std::uint64_t bytes = 0;
    for (const std::span<const std::byte> part : upload.parts) bytes += part.size();
    const Result<gpu::Allocation> block = geometry_.allocate(bytes);
    if (!block) return failAgain(block.error());
    upload.block = *block;
  } else if (const auto* codebook = std::get_if<CodebookChunk>(&upload.item)) {
    if (Result<void> written = writeTables(at, *codebook); !written) return failAgain(written.error());
    upload.parts = {partOf(codebook->codebook.vectors)};
  }
  return upload;
}

std::uint64_t Residency::proceed(At at, Upload& upload, std::uint64_t max_bytes) {
  std::uint64_t bytes = 0;
  for (; !upload.whole(); ++upload.part, upload.part_done = 0) {
    const std::span<const std::byte> left = upload.parts[upload.part].subspan(upload.part_done);
    std::uint64_t room = (max_bytes - bytes) / upload.granule * upload.granule;
    if (bytes == 0) room = std::max(room, upload.granule);
    const std::span<const std::byte> piece = left.first(std::min<std::uint64_t>(room, left.size()));
    if (!piece.empty()) write(at, upload, piece);
    bytes += piece.size();
    upload.part_done += piece.size();
    upload.all_done += piece.size();
    if (piece.size() < left.size()) break;
  }
  return bytes;
}

void Residency::write(At at, const Upload& upload, std::span<const std::byte> piece) {
  if (std::holds_alternative<ImageChunk>(upload.item)) {
    const gpu::Texture& texture = upload.color && upload.part == 0 ? upload.color : upload.linear;
    writeRows(texture, static_cast<std::uint32_t>(upload.part_done / upload.granule), piece);
  } else if (const auto* codebook = std::get_if<CodebookChunk>(&upload.item)) {
    const ResidentCell& cell = cellOf(at.tables, at.bundle, codebook->group, codebook->cell);
    const std::uint32_t first_word =
        cell.transfers[codebook->transfer.value].vectors_word - cell.block.word();
    transfer_.write(cell.block, 4ull * first_word + upload.part_done, piece);
  } else {
    geometry_.write(upload.block, upload.all_done, piece);
  }
}

Result<void> Residency::finish(At at, Upload upload) {
  if (const auto* image = std::get_if<ImageChunk>(&upload.item)) {
    const auto take = [&](gpu::Texture& made, gpu::Texture& shown) {
      if (!made) return;
      glGenerateTextureMipmap(made.id());
      at.bundle.texture_bytes += bytesOfTexture(made) - bytesOfTexture(shown);
      shown = std::move(made);
    };
    take(upload.color, at.bundle.images[image->image]);
    take(upload.linear, at.bundle.linear_images[image->image]);
  } else if (const auto* codebook = std::get_if<CodebookChunk>(&upload.item)) {
    ResidentCell& cell = cellOf(at.tables, at.bundle, codebook->group, codebook->cell);
    cell.transfers[codebook->transfer.value].codebook_resident = true;
    cell.version = version_;
  } else {
    return finishMesh(at, upload);
  }
  return {};
}

Result<void> Residency::finishMesh(At at, const Upload& upload) {
  const auto& item = std::get<MeshChunk>(upload.item);
  const std::uint32_t index = at.bundle.first.meshes + at.bundle.first_primitive[item.mesh] + item.primitive;
  ResidentMesh& mesh = at.tables.meshes[index];
  assert(item.data.positions.size() == mesh.vertex_count && item.data.indices.size() == mesh.index_count);
  mesh.block = upload.block;
  mesh.mean_edge = item.mean_edge;
  // In the order of the parts.
  const std::array<std::uint32_t*, 7> word_of = {
      &mesh.positions_word, &mesh.normals_word,  &mesh.texcoords_word[0], &mesh.texcoords_word[1],
      &mesh.colors_word,    &mesh.tangents_word, &mesh.indices_word};
  std::uint64_t offset = 0;
  for (std::size_t i = 0; i < word_of.size(); ++i) {
    if (upload.parts[i].empty()) continue;
    *word_of[i] = mesh.block.word() + static_cast<std::uint32_t>(offset / 4);
    offset += upload.parts[i].size();
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
  write(transfer.clusters_word, partOf(clusters));
  write(transfer.weights_word, partOf(weights));
  write(transfer.positions_word, partOf(item.positions));
  return {};
}

void Residency::dropLevels(std::uint32_t bundle, std::uint32_t image, std::uint32_t levels) {
  ResidentBundle& owner = tables_.bundles[bundle];
  for (gpu::Texture* texture : {&owner.images[image], &owner.linear_images[image]}) {
    if (!*texture || texture->desc().levels <= levels) continue;
    ++version_;
    gpu::Texture rest = coarser(*texture, texture->desc().levels - levels, labelOf(image));
    owner.texture_bytes -= bytesOfTexture(*texture) - bytesOfTexture(rest);
    *texture = std::move(rest);
  }
}

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
