#include "runtime/streaming/residency.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/packing.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "runtime/streaming/sizes.hpp"

namespace lambent::streaming {

namespace {

template <typename T>
std::span<const std::byte> bytesOf(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

std::uint32_t words(std::uint64_t byte_count) {
  return static_cast<std::uint32_t>((byte_count + 3) / 4);
}

// Small bundles share a page.
constexpr std::uint64_t kMinPageBytes = std::uint64_t{1} << 20;

ResidentTransfer describe(const bundle::CellTransfer& transfer) {
  ResidentTransfer resident;
  resident.shape = transfer.shape;
  resident.clusters = transfer.clusters;
  resident.axes = transfer.axes;
  for (const bundle::WeightPlane& plane : transfer.planes)
    resident.planes.push_back(
        {.word = 0, .bits = plane.bits, .count = plane.count, .variance = plane.variance});
  return resident;
}

// Places everything of a cell from `word` on; returns the word after.
std::uint32_t layOut(ResidentCell& cell, std::uint32_t word) {
  if (cell.light_samples.size() > 1) {
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
    for (ResidentPlane& plane : transfer.planes) {
      plane.word = word;
      word += words(std::uint64_t{plane.count} * plane.bits / 8);
    }
  }
  return word;
}

// Normals go by the inverse transpose; the group's own placement has no scale. A flattened mesh has no
// inverse: its normals then go by the matrix itself, which keeps them finite.
glm::mat3 normalMatrix(const bundle::Group& group, const glm::mat4& world_from_mesh) {
  const glm::mat3 linear = glm::mat3_cast(glm::conjugate(group.rest_rotation)) * glm::mat3(world_from_mesh);
  const float determinant = glm::determinant(linear);
  if (determinant == 0.0f || !std::isfinite(1.0f / determinant)) return linear;
  return glm::transpose(glm::inverse(linear));
}

std::uint32_t mipLevels(std::uint32_t width, std::uint32_t height) {
  return static_cast<std::uint32_t>(std::bit_width(std::max(width, height)));
}

float meanEdge(const bundle::MeshData& mesh) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    for (std::size_t k = 0; k < 3; ++k)
      sum += double{
          glm::distance(mesh.positions[mesh.indices[i + k]], mesh.positions[mesh.indices[i + (k + 1) % 3]])};
  return mesh.indices.empty() ? 0.0f : static_cast<float>(sum / static_cast<double>(mesh.indices.size()));
}

gpu::Texture makeTexture(const std::string& label, GLenum format, const ImageReady& image) {
  gpu::Texture texture(label, {.format = format,
                               .width = image.width,
                               .height = image.height,
                               .levels = mipLevels(image.width, image.height)});
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTextureSubImage2D(texture.id(), 0, 0, 0, static_cast<GLsizei>(image.width),
                      static_cast<GLsizei>(image.height), GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  glGenerateTextureMipmap(texture.id());
  return texture;
}

// Linear between voxel centres, constant in the half voxel towards the faces. Codes of 8 bits too are kept in
// 16: some devices interpolate texels of 8 bits with results of 8 bits.
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
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTextureParameteri(texture.id(), axis, GL_CLAMP_TO_EDGE);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTextureParameteri(texture.id(), filter, GL_LINEAR);
  return texture;
}

}  // namespace

bool ResidentCell::usable() const {
  if (!light_weights_resident) return false;
  for (const ResidentTransfer& transfer : transfers) {
    if (!transfer.codebook_resident) return false;
    if (transfer.planes_resident == transfer.planes.size()) continue;
    float all = 0.0f, here = 0.0f;
    for (std::size_t i = 0; i < transfer.planes.size(); ++i) {
      all += transfer.planes[i].variance;
      if (i < transfer.planes_resident) here += transfer.planes[i].variance;
    }
    if (here < kUsableVariance * all || here == 0.0f) return false;
  }
  return !transfers.empty();
}

Residency::Residency(std::uint64_t max_page_bytes)
    : max_page_bytes_(max_page_bytes),
      geometry_("geometry"),
      transfer_("transfer"),
      samples_("samples"),
      rows_("rows"),
      radiance_("radiance") {}

Result<std::uint32_t> Residency::add(const bundle::Description& description) {
  const auto bundle_index = static_cast<std::uint32_t>(bundles_.size());
  ResidentBundle bundle{.materials = description.materials,
                        .textures = description.textures,
                        .images = std::vector<gpu::Texture>(description.images.size()),
                        .linear_images = std::vector<gpu::Texture>(description.images.size()),
                        .image_uses = imageUses(description),
                        .brdf_families = {},
                        .brdf_tables = std::vector<BrdfTexture>(description.brdf_tables.size()),
                        .first_group = static_cast<std::uint32_t>(groups_.size()),
                        .first_draw = static_cast<std::uint32_t>(draws_.size()),
                        .first_mesh = {}};
  for (const bundle::BrdfTableEntry& entry : description.brdf_tables)
    bundle.brdf_families.push_back(entry.family);
  for (const bundle::Mesh& mesh : description.meshes) {
    bundle.first_mesh.push_back(static_cast<std::uint32_t>(meshes_.size()));
    for (const bundle::Primitive& primitive : mesh.primitives) {
      ResidentMesh resident;
      resident.vertex_count = primitive.vertex_count;
      resident.index_count = primitive.index_count;
      resident.center = 0.5f * (primitive.bounds_min + primitive.bounds_max);
      meshes_.push_back(resident);
    }
  }
  std::vector<ResidentGroup> groups;
  for (const bundle::Group& group : description.groups) {
    ResidentGroup resident{.bundle = bundle_index,
                           .index = static_cast<std::uint32_t>(groups.size()),
                           .order = 1,
                           .light_columns = static_cast<std::uint32_t>(group.lights.size()),
                           .first_cell = static_cast<std::uint32_t>(cells_.size()),
                           .cell_count = static_cast<std::uint32_t>(group.cells.size()),
                           .plain_samples = group.samplesWith(1),
                           .mapped_samples = group.samplesWith(bundle::kMappedOutputs),
                           .glossy_outputs = 0,
                           .samples = {},
                           .light_samples = group.light_samples,
                           .volume = -1,
                           .proxy = {}};
    std::uint32_t next_output = 0;
    for (const bundle::Cell& cell : group.cells) {
      ResidentCell resident_cell{.group = bundle.first_group + resident.index,
                                 .kind = cell.kind,
                                 .first_sample = cell.first_sample,
                                 .sample_count = cell.sample_count,
                                 .outputs = cell.outputs(),
                                 .first_output = next_output,  // from where the group's samples will lie
                                 .block = {},
                                 .transfers = {},
                                 .light_samples = cell.light_samples,
                                 .light_weights_resident = cell.light_samples.size() == 1,
                                 .version = version_};
      for (const bundle::CellTransfer& transfer : cell.transfers) {
        resident_cell.transfers.push_back(describe(transfer));
        resident.order = std::max(resident.order, transfer.shape.order);
      }
      next_output += resident_cell.outputs * resident_cell.sample_count;
      if (resident_cell.kind == bundle::CellKind::Surface && bundle::isGlossy(resident_cell.outputs))
        resident.glossy_outputs = resident_cell.outputs;
      cells_.push_back(std::move(resident_cell));
    }
    if (group.volume) {
      resident.volume = static_cast<std::int32_t>(volumes_.size());
      ResidentVolume volume;
      volume.group = bundle.first_group + resident.index;
      volume.grid = *group.volume;
      volume.outputs = group.cells.empty() ? 1 : group.cells.front().outputs();
      volume.sample_count = group.sample_count;
      volume.version = version_;
      volumes_.push_back(std::move(volume));
    }
    groups.push_back(resident);
  }
  const std::vector<glm::mat4> world_from_node = gltf::worldTransforms(description.nodes);
  for (std::uint32_t i = 0; i < description.draws.size(); ++i) {
    const bundle::Draw& draw = description.draws[i];
    const std::uint32_t mesh = bundle.first_mesh[draw.mesh] + draw.primitive;
    draws_.push_back(
        {.bundle = bundle_index,
         .index = i,
         .group = bundle.first_group + draw.group,
         .mesh = mesh,
         .material = description.meshes[draw.mesh].primitives[draw.primitive].material,
         .back = draw.back,
         .outputs = draw.outputs,
         .group_from_mesh_normal = (draw.back ? -1.0f : 1.0f) *
                                   normalMatrix(description.groups[draw.group], world_from_node[draw.node]),
         .rows = {},
         .row_entries = 0,
         .radiance = {},
         .version = version_});
  }
  const Needs needs = needsOf(description);
  const auto page_bytes = [&](std::uint64_t need) {
    return std::min(std::max(need, kMinPageBytes), max_page_bytes_);
  };
  geometry_.setPageBytes(page_bytes(needs.geometry));
  transfer_.setPageBytes(page_bytes(needs.transfer));
  samples_.setPageBytes(page_bytes(needs.samples));
  rows_.setPageBytes(page_bytes(needs.rows));
  radiance_.setPageBytes(page_bytes(needs.radiance));
  for (ResidentGroup& group : groups) {
    const std::uint64_t sample_count = samplesOf(description.groups[group.index]);
    if (sample_count > 0) {
      const Result<gpu::Allocation> samples = samples_.allocate(16 * sample_count);
      if (!samples) return failAgain(samples.error());
      group.samples = *samples;
      samples_.clear(*samples);
      for (std::uint32_t c = 0; c < group.cell_count; ++c)
        cells_[group.first_cell + c].first_output += group.samples.word() / 4;
    }
    groups_.push_back(group);
  }
  bundles_.push_back(std::move(bundle));
  ++version_;
  ++proxies_version_;
  return bundle_index;
}

Result<void> Residency::upload(std::uint32_t bundle, const Ready& item) {
  assert(bundle < bundles_.size());
  ++version_;
  return std::visit([&](const auto& ready) { return put(bundle, ready); }, item);
}

Result<void> Residency::put(std::uint32_t bundle, const MeshReady& item) {
  const std::uint32_t index = bundles_[bundle].first_mesh[item.mesh] + item.primitive;
  ResidentMesh& mesh = meshes_[index];
  const bundle::MeshData& data = item.data;
  assert(data.positions.size() == mesh.vertex_count && data.indices.size() == mesh.index_count);
  std::vector<std::uint64_t> colors;
  colors.reserve(data.colors.size());
  for (const glm::vec4& color : data.colors) colors.push_back(glm::packUnorm4x16(color));
  const std::span<const std::byte> parts[] = {
      bytesOf(data.positions), bytesOf(data.normals),  bytesOf(data.texcoords0), bytesOf(data.texcoords1),
      bytesOf(colors),         bytesOf(data.tangents), bytesOf(data.indices)};
  std::uint64_t byte_count = 0;
  for (const auto& part : parts) byte_count += part.size();
  const Result<gpu::Allocation> block = geometry_.allocate(byte_count);
  if (!block) return failAgain(block.error());
  mesh.block = *block;
  mesh.mean_edge = meanEdge(data);
  std::uint32_t* const word_of[] = {&mesh.positions_word,    &mesh.normals_word, &mesh.texcoords_word[0],
                                    &mesh.texcoords_word[1], &mesh.colors_word,  &mesh.tangents_word,
                                    &mesh.indices_word};
  std::uint64_t offset = 0;
  for (std::size_t i = 0; i < std::size(parts); ++i) {
    if (parts[i].empty()) continue;
    *word_of[i] = mesh.block.word() + static_cast<std::uint32_t>(offset / 4);
    geometry_.write(mesh.block, offset, parts[i]);
    offset += parts[i].size();
  }
  for (ResidentDraw& draw : draws_) {
    if (draw.mesh != index) continue;
    draw.version = version_;
    if (draw.glossy()) continue;
    const Result<gpu::Allocation> radiance =
        radiance_.allocate(4ull * radianceWords(draw.outputs) * mesh.vertex_count);
    if (!radiance) return failAgain(radiance.error());
    draw.radiance = *radiance;
  }
  return {};
}

Result<void> Residency::put(std::uint32_t bundle, const ImageReady& item) {
  ResidentBundle& owner = bundles_[bundle];
  const ImageUse use = owner.image_uses[item.image];
  const std::string label = fmt::format("image {}.{}", bundle, item.image);
  if (use.color) owner.images[item.image] = makeTexture(label, GL_SRGB8_ALPHA8, item);
  if (use.linear) owner.linear_images[item.image] = makeTexture(label + " linear", GL_RGBA8, item);
  texture_bytes_ += std::uint64_t{use.copies()} * item.width * item.height * 4 * 4 / 3;
  return {};
}

Result<void> Residency::put(std::uint32_t bundle, const RowsReady& item) {
  ResidentDraw& draw = draws_[bundles_[bundle].first_draw + item.draw];
  const bundle::VertexRows& rows = item.rows;
  const std::size_t entries = rows.samples.size();
  assert(rows.offsets.size() == meshes_[draw.mesh].vertex_count + 1u && rows.weights.size() == entries);
  std::vector<std::uint16_t> weights(entries);
  std::transform(rows.weights.begin(), rows.weights.end(), weights.begin(),
                 [](float weight) { return glm::packUnorm1x16(weight); });
  const std::uint64_t samples_at = 4ull * rows.offsets.size(), weights_at = samples_at + 4ull * entries;
  const Result<gpu::Allocation> block = rows_.allocate(weights_at + 2 * entries);
  if (!block) return failAgain(block.error());
  rows_.write(*block, 0, bytesOf(rows.offsets));
  rows_.write(*block, samples_at, bytesOf(rows.samples));
  rows_.write(*block, weights_at, bytesOf(weights));
  draw.rows = *block;
  draw.row_entries = static_cast<std::uint32_t>(entries);
  draw.version = version_;
  return {};
}

ResidentCell& Residency::cellOf(std::uint32_t bundle, std::uint32_t group, std::uint32_t cell) {
  return cells_[groups_[bundles_[bundle].first_group + group].first_cell + cell];
}

Result<void> Residency::reserveCell(ResidentCell& cell) {
  if (cell.block) return {};
  const Result<gpu::Allocation> block = transfer_.allocate(4ull * layOut(cell, 0));
  if (!block) return failAgain(block.error());
  cell.block = *block;
  layOut(cell, block->word());
  return {};
}

Result<void> Residency::put(std::uint32_t bundle, const CodebookReady& item) {
  ResidentCell& cell = cellOf(bundle, item.group, item.cell);
  if (Result<void> reserved = reserveCell(cell); !reserved) return reserved;
  ResidentTransfer& transfer = cell.transfers[item.transfer];
  const bundle::Codebook& codebook = item.codebook;
  assert(codebook.clusters() == transfer.clusters && codebook.axes.size() == transfer.axes &&
         item.positions.size() == cell.sample_count);
  std::vector<std::uint32_t> clusters;
  std::vector<bundle::AxisCode> weights;
  for (std::size_t c = 0, axis = 0; c < codebook.clusters(); ++c) {
    const std::uint32_t axes = codebook.axis_counts[c];
    clusters.insert(clusters.end(), {static_cast<std::uint32_t>(weights.size()), axes});
    weights.push_back({.offset = 1.0f, .scale = 0.0f});  // the mean
    for (std::uint32_t j = 0; j < axes; ++j) weights.push_back(codebook.axes[axis++]);
  }
  const auto write = [&](std::uint32_t word, std::span<const std::byte> bytes) {
    transfer_.write(cell.block, 4ull * (word - cell.block.word()), bytes);
  };
  write(transfer.clusters_word, bytesOf(clusters));
  write(transfer.weights_word, bytesOf(weights));
  write(transfer.vectors_word, bytesOf(codebook.vectors));
  write(transfer.positions_word, bytesOf(item.positions));
  transfer.codebook_resident = true;
  cell.version = version_;
  return {};
}

Result<void> Residency::put(std::uint32_t bundle, const PlaneReady& item) {
  ResidentCell& cell = cellOf(bundle, item.group, item.cell);
  if (Result<void> reserved = reserveCell(cell); !reserved) return reserved;
  ResidentTransfer& transfer = cell.transfers[item.transfer];
  // The loader delivers the planes of a cell in order, so what is here is always a prefix.
  assert(item.plane == transfer.planes_resident);
  transfer_.write(cell.block, 4ull * (transfer.planes[item.plane].word - cell.block.word()), item.codes);
  transfer.planes_resident = item.plane + 1;
  cell.version = version_;
  return {};
}

Result<void> Residency::put(std::uint32_t bundle, const LightWeightsReady& item) {
  ResidentCell& cell = cellOf(bundle, item.group, item.cell);
  if (Result<void> reserved = reserveCell(cell); !reserved) return reserved;
  assert(item.samples.size() == cell.sample_count && cell.light_samples.size() > 1);
  static_assert(sizeof(bundle::LightWeights) == 4 * kLightWeightWords);
  transfer_.write(cell.block, 4ull * (cell.light_weights_word - cell.block.word()), bytesOf(item.samples));
  cell.light_weights_resident = true;
  cell.version = version_;
  return {};
}

Result<void> Residency::put(std::uint32_t bundle, const ProxyReady& item) {
  groups_[bundles_[bundle].first_group + item.group].proxy = item.proxy;
  ++proxies_version_;
  return {};
}

Result<void> Residency::put(std::uint32_t bundle, const BrdfReady& item) {
  Result<BrdfTexture> made =
      makeBrdfTexture(item.data, item.texels, fmt::format("BRDF table {}", item.table));
  if (!made) return failAgain(made.error());
  bundles_[bundle].brdf_tables[item.table] = std::move(*made);
  texture_bytes_ += item.texels.bytes();
  return {};
}

ResidentVolume& Residency::volumeOf(std::uint32_t bundle, std::uint32_t group) {
  return volumes_[static_cast<std::size_t>(groups_[bundles_[bundle].first_group + group].volume)];
}

Result<void> Residency::put(std::uint32_t bundle, const DensityReady& item) {
  ResidentVolume& volume = volumeOf(bundle, item.group);
  volume.density = makeDensityTexture(volume.grid, item.codes);
  volume.block_maxima = item.block_maxima;
  volume.version = version_;
  texture_bytes_ += densityBytes(volume.grid.size);
  return {};
}

Result<void> Residency::put(std::uint32_t bundle, const VoxelsReady& item) {
  ResidentVolume& volume = volumeOf(bundle, item.group);
  assert(item.voxels.size() == volume.sample_count);
  const std::span<const std::byte> bytes = bytesOf(item.voxels);
  volume.voxels = gpu::Buffer("voxels", std::max<std::size_t>(bytes.size(), 4));
  volume.voxels.writeBytes(0, bytes);
  volume.version = version_;
  texture_bytes_ += bytes.size();
  return {};
}

std::uint64_t Residency::bytesResident() const {
  return geometry_.bytesUsed() + transfer_.bytesUsed() + samples_.bytesUsed() + rows_.bytesUsed() +
         radiance_.bytesUsed() + texture_bytes_;
}

std::uint64_t Residency::planesResident() const {
  std::uint64_t planes = 0;
  for (const ResidentCell& cell : cells_)
    for (const ResidentTransfer& transfer : cell.transfers) planes += transfer.planes_resident;
  return planes;
}

std::uint64_t Residency::uploadBytes(const Ready& item) {
  struct Size {
    std::uint64_t operator()(const MeshReady& mesh) const {
      return 24ull * mesh.data.positions.size() + 8ull * mesh.data.texcoords0.size() +
             8ull * mesh.data.texcoords1.size() + 8ull * mesh.data.colors.size() +
             16ull * mesh.data.tangents.size() + 4ull * mesh.data.indices.size();
    }
    std::uint64_t operator()(const ImageReady& image) const { return image.rgba.size(); }
    std::uint64_t operator()(const RowsReady& rows) const {
      return 4ull * rows.rows.offsets.size() + 6ull * rows.rows.samples.size();
    }
    std::uint64_t operator()(const CodebookReady& ready) const {
      const bundle::Codebook& codebook = ready.codebook;
      return 16ull * codebook.clusters() + 8ull * codebook.axes.size() + 4ull * codebook.vectors.size() +
             4ull * ready.positions.size();
    }
    std::uint64_t operator()(const PlaneReady& plane) const { return plane.codes.size(); }
    std::uint64_t operator()(const LightWeightsReady& weights) const {
      return sizeof(bundle::LightWeights) * weights.samples.size();
    }
    std::uint64_t operator()(const ProxyReady&) const { return 0; }  // stays in memory
    std::uint64_t operator()(const BrdfReady& ready) const { return ready.texels.bytes(); }
    std::uint64_t operator()(const DensityReady& density) const { return density.codes.size(); }  // or twice
    std::uint64_t operator()(const VoxelsReady& ready) const { return 4 * ready.voxels.size(); }
  };
  return std::visit(Size{}, item);
}

}  // namespace lambent::streaming
