#include "runtime/streaming/residency.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/packing.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

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

// What a bundle will need in each arena: pages are made no larger.
struct Needs {
  std::uint64_t geometry = 0, transfer = 0, samples = 0, rows = 0, radiance = 0;
};

std::uint64_t codeBytes(std::uint64_t sample_count, std::uint32_t bits) {
  return words(sample_count * bits / 8) * 4ull;
}

std::uint64_t cellBytes(const ResidentCell& cell) {
  std::uint64_t bytes = 0;
  for (const ResidentTransfer& transfer : cell.transfers) {
    bytes += 4ull * (1 + transfer.planes.size()) * transfer.channels * transfer.columns;
    for (const ResidentPlane& plane : transfer.planes) bytes += codeBytes(cell.sample_count, plane.bits);
  }
  return bytes;
}

ResidentTransfer describe(const bundle::DiffuseTransfer& transfer) {
  ResidentTransfer resident{.part = transfer.part,
                            .order = transfer.order,
                            .columns = transfer.columns(),
                            .channels = transfer.channels,
                            .basis_word = 0,
                            .planes = {},
                            .basis_resident = false,
                            .planes_resident = 0};
  for (const bundle::WeightPlane& plane : transfer.planes)
    resident.planes.push_back({.word = 0,
                               .bits = plane.bits,
                               .offset = plane.offset,
                               .scale = plane.scale,
                               .variance = plane.variance});
  return resident;
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

std::vector<ImageUse> imageUses(const bundle::Description& description) {
  std::vector<ImageUse> uses(description.images.size());
  const auto useOf = [&](const gltf::TextureRef& reference) -> ImageUse* {
    if (reference.texture < 0) return nullptr;
    const std::int32_t image = description.textures[static_cast<std::size_t>(reference.texture)].image;
    return image >= 0 ? &uses[static_cast<std::size_t>(image)] : nullptr;
  };
  for (const gltf::Material& material : description.materials) {
    if (ImageUse* use = useOf(material.base_color_texture)) use->color = true;
    if (ImageUse* use = useOf(material.emissive_texture)) use->color = true;
    if (ImageUse* use = useOf(material.normal_texture)) use->normals = true;
  }
  // What no material names may yet be asked for: as colour, the usual.
  for (ImageUse& use : uses) use.color |= !use.normals;
  return uses;
}

}  // namespace

bool ResidentCell::usable() const {
  for (const ResidentTransfer& transfer : transfers) {
    if (!transfer.basis_resident) return false;
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
                        .first_group = static_cast<std::uint32_t>(groups_.size()),
                        .first_draw = static_cast<std::uint32_t>(draws_.size()),
                        .first_mesh = {}};
  Needs needs;
  for (const bundle::Mesh& mesh : description.meshes) {
    bundle.first_mesh.push_back(static_cast<std::uint32_t>(meshes_.size()));
    for (const bundle::Primitive& primitive : mesh.primitives) {
      ResidentMesh resident;
      resident.vertex_count = primitive.vertex_count;
      resident.index_count = primitive.index_count;
      resident.center = 0.5f * (primitive.bounds_min + primitive.bounds_max);
      meshes_.push_back(resident);
      needs.geometry +=
          64ull * primitive.vertex_count + 4ull * primitive.index_count + gpu::Arena::kAlignment;
    }
  }
  std::vector<ResidentGroup> groups;
  for (const bundle::Group& group : description.groups) {
    ResidentGroup resident{.bundle = bundle_index,
                           .index = static_cast<std::uint32_t>(groups.size()),
                           .order = 1,
                           .light_columns = 0,
                           .first_cell = static_cast<std::uint32_t>(cells_.size()),
                           .cell_count = static_cast<std::uint32_t>(group.cells.size()),
                           .samples = {}};
    for (const bundle::Cell& cell : group.cells) {
      ResidentCell resident_cell{.group = bundle.first_group + resident.index,
                                 .first_sample = cell.first_sample,
                                 .sample_count = cell.sample_count,
                                 .block = {},
                                 .transfers = {},
                                 .version = version_};
      for (const bundle::DiffuseTransfer& transfer : cell.diffuse) {
        resident_cell.transfers.push_back(describe(transfer));
        resident.order = std::max(resident.order, transfer.order);
        resident.light_columns = std::max(resident.light_columns, transfer.light_columns);
      }
      needs.transfer += cellBytes(resident_cell) + gpu::Arena::kAlignment;
      cells_.push_back(std::move(resident_cell));
    }
    needs.samples += 16ull * group.sample_count;
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
         .group_from_mesh_normal = (draw.back ? -1.0f : 1.0f) *
                                   normalMatrix(description.groups[draw.group], world_from_node[draw.node]),
         .rows = {},
         .row_entries = 0,
         .radiance = {},
         .version = version_});
    needs.rows += description.payloads[draw.rows].raw_length + 4ull * meshes_[mesh].vertex_count + 32;
    needs.radiance += 12ull * meshes_[mesh].vertex_count + gpu::Arena::kAlignment;
  }
  const auto page_bytes = [&](std::uint64_t need) {
    return std::min(std::max(need, kMinPageBytes), max_page_bytes_);
  };
  geometry_.setPageBytes(page_bytes(needs.geometry));
  transfer_.setPageBytes(page_bytes(needs.transfer));
  samples_.setPageBytes(page_bytes(needs.samples));
  rows_.setPageBytes(page_bytes(needs.rows));
  radiance_.setPageBytes(page_bytes(needs.radiance));
  for (ResidentGroup& group : groups) {
    const std::uint32_t sample_count = description.groups[group.index].sample_count;
    if (sample_count > 0) {
      const Result<gpu::Allocation> samples = samples_.allocate(16ull * sample_count);
      if (!samples) return failAgain(samples.error());
      group.samples = *samples;
      samples_.clear(*samples);
    }
    groups_.push_back(group);
  }
  bundles_.push_back(std::move(bundle));
  ++version_;
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
    const Result<gpu::Allocation> radiance = radiance_.allocate(12ull * mesh.vertex_count);
    if (!radiance) return failAgain(radiance.error());
    draw.radiance = *radiance;
    draw.version = version_;
  }
  return {};
}

Result<void> Residency::put(std::uint32_t bundle, const ImageReady& item) {
  ResidentBundle& owner = bundles_[bundle];
  const ImageUse use = owner.image_uses[item.image];
  const std::string label = fmt::format("image {}.{}", bundle, item.image);
  if (use.color) owner.images[item.image] = makeTexture(label, GL_SRGB8_ALPHA8, item);
  if (use.normals) owner.linear_images[item.image] = makeTexture(label + " linear", GL_RGBA8, item);
  const std::uint64_t copies = (use.color ? 1u : 0u) + (use.normals ? 1u : 0u);
  texture_bytes_ += copies * item.width * item.height * 4 * 4 / 3;
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
  const Result<gpu::Allocation> block = transfer_.allocate(cellBytes(cell));
  if (!block) return failAgain(block.error());
  cell.block = *block;
  std::uint32_t word = block->word();
  for (ResidentTransfer& transfer : cell.transfers) {
    transfer.basis_word = word;
    word += static_cast<std::uint32_t>((1 + transfer.planes.size()) * transfer.channels * transfer.columns);
    for (ResidentPlane& plane : transfer.planes) {
      plane.word = word;
      word += words(codeBytes(cell.sample_count, plane.bits));
    }
  }
  return {};
}

Result<void> Residency::put(std::uint32_t bundle, const BasisReady& item) {
  ResidentCell& cell = cellOf(bundle, item.group, item.cell);
  if (Result<void> reserved = reserveCell(cell); !reserved) return reserved;
  ResidentTransfer& transfer = cell.transfers[item.transfer];
  assert(item.vectors.size() == (1 + transfer.planes.size()) * transfer.channels * transfer.columns);
  transfer_.write(cell.block, 4ull * (transfer.basis_word - cell.block.word()), bytesOf(item.vectors));
  transfer.basis_resident = true;
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

std::uint64_t Residency::bytesResident() const {
  return geometry_.bytesUsed() + transfer_.bytesUsed() + samples_.bytesUsed() + rows_.bytesUsed() +
         radiance_.bytesUsed() + texture_bytes_;
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
    std::uint64_t operator()(const BasisReady& basis) const { return 4ull * basis.vectors.size(); }
    std::uint64_t operator()(const PlaneReady& plane) const { return plane.codes.size(); }
  };
  return std::visit(Size{}, item);
}

}  // namespace lambent::streaming
