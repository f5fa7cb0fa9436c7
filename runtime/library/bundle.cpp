#include "lambent/bundle.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <tuple>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "runtime/base/normal_matrix.hpp"
#include "runtime/bundle/container.hpp"
#include "runtime/library/convert.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/transfer/codebook.hpp"

namespace lambent {

namespace {

using library::failureOf;
using library::fromGlm;

// The enumerations of the library have the values of the room's.
static_assert(static_cast<int>(TransferForm::Matrix) == static_cast<int>(transfer::Form::Matrix));
static_assert(static_cast<int>(TransferPlace::Neighborhood) == static_cast<int>(transfer::Domain::GridPoint));

std::string lampName(const bundle::Description& description, const bundle::GroupLight& lamp) {
  return lamp.kind == bundle::GroupLight::Kind::Material ? description.materials[lamp.index].name
                                                         : description.nodes[lamp.index].name;
}

TransferBlock blockOf(const bundle::Cell& cell, const transfer::TransferShape& shape) {
  TransferBlock block{.form = static_cast<TransferForm>(shape.form(cell.domain)),
                      .place = static_cast<TransferPlace>(cell.domain),
                      .first_sample = cell.first_sample,
                      .samples = cell.sample_count,
                      .order = shape.order,
                      .lamps = shape.light_columns,
                      .shadowed_channels = shape.shadowed_channels,
                      .full_channels = shape.full_channels,
                      .outputs = shape.outputs,
                      .columns = shape.columns()};
  if (shape.isVisibility()) {
    block.shadowed_channels = block.outputs = 1;
    block.full_channels = block.lamps = 0;
    block.columns = shape.size();
  }
  return block;
}

}  // namespace

const char* nameOf(TransferForm form) {
  constexpr const char* kNames[] = {"vector", "normal-mapped", "visibility", "matrix"};
  return kNames[static_cast<std::size_t>(form)];
}

const char* nameOf(TransferPlace place) {
  constexpr const char* kNames[] = {"surface", "volume", "neighborhood"};
  return kNames[static_cast<std::size_t>(place)];
}

struct Bundle::File {
  bundle::Reader reader;
  std::vector<glm::mat4> world_from_node;  // as baked
  std::vector<GroupInfo> groups;
  std::vector<SurfaceInfo> surfaces;

  const bundle::Description& description() const { return reader.description(); }
  glm::mat4 worldFromGroup(std::uint32_t group) const {
    const bundle::Group& g = description().groups[group];
    glm::mat4 matrix = glm::mat4_cast(g.rest_rotation);
    matrix[3] = glm::vec4(g.rest_translation, 1.0f);
    return matrix;
  }
  Failure noSuch(const char* what, std::size_t index, std::size_t count) const {
    return {reader.path().string(), fmt::format("has no {} {}", what, index),
            fmt::format("it has {}", count)};
  }
};

Bundle::Bundle(std::unique_ptr<File> file) : file_(std::move(file)) {}
Bundle::Bundle(Bundle&&) noexcept = default;
Bundle& Bundle::operator=(Bundle&&) noexcept = default;
Bundle::~Bundle() = default;

Expected<Bundle> Bundle::open(const std::string& path) {
  Result<bundle::Reader> reader = bundle::Reader::open(path);
  if (!reader) return failureOf(reader.error());
  auto file = std::make_unique<File>(
      File{.reader = std::move(*reader), .world_from_node = {}, .groups = {}, .surfaces = {}});
  const bundle::Description& description = file->description();
  file->world_from_node = gltf::worldTransforms(description.nodes);
  for (std::uint32_t g = 0; g < description.groups.size(); ++g) {
    const bundle::Group& group = description.groups[g];
    GroupInfo info{.name = group.name,
                   .samples = group.sample_count,
                   .world_from_group = fromGlm(file->worldFromGroup(g)),
                   .bounds_min = fromGlm(group.bounds_min),
                   .bounds_max = fromGlm(group.bounds_max),
                   .lamps = {},
                   .blocks = {}};
    for (const bundle::GroupLight& lamp : group.lights) info.lamps.push_back(lampName(description, lamp));
    for (const bundle::Cell& cell : group.cells)
      for (const bundle::CellTransfer& transfer : cell.transfers)
        info.blocks.push_back(blockOf(cell, transfer.shape));
    file->groups.push_back(std::move(info));
  }
  for (const bundle::Draw& draw : description.draws) {
    const bundle::Mesh& mesh = description.meshes[draw.mesh];
    const bundle::Primitive& primitive = mesh.primitives[draw.primitive];
    SurfaceInfo info{.mesh = mesh.name,
                     .material = {},
                     .group = draw.group,
                     .vertices = primitive.vertex_count,
                     .triangles = primitive.index_count / 3,
                     .back = draw.back,
                     .form = static_cast<TransferForm>(draw.form())};
    if (primitive.material >= 0) {
      const gltf::Material& material = description.materials[static_cast<std::size_t>(primitive.material)];
      info.material = material.name;
      info.albedo = fromGlm(glm::vec3(material.base_color));
    }
    file->surfaces.push_back(std::move(info));
  }
  return Bundle(std::move(file));
}

const std::vector<GroupInfo>& Bundle::groups() const {
  return file_->groups;
}
const std::vector<SurfaceInfo>& Bundle::surfaces() const {
  return file_->surfaces;
}

Expected<SurfaceData> Bundle::surface(std::uint32_t index) const {
  const bundle::Description& description = file_->description();
  if (index >= description.draws.size()) return file_->noSuch("surface", index, description.draws.size());
  const bundle::Draw& draw = description.draws[index];
  const Result<bundle::MeshData> mesh = file_->reader.readMesh(draw.mesh, draw.primitive);
  if (!mesh) return failureOf(mesh.error());
  Result<transfer::VertexWeights> rows = file_->reader.readRows(index);
  if (!rows) return failureOf(rows.error());

  const glm::mat4 group_from_mesh =
      glm::inverse(file_->worldFromGroup(draw.group)) * file_->world_from_node[draw.node];
  const glm::mat3 for_normals = (draw.back ? -1.0f : 1.0f) * normalMatrix(glm::mat3(group_from_mesh));
  SurfaceData data;
  for (const glm::vec3& position : mesh->positions)
    data.positions.push_back(fromGlm(glm::vec3(group_from_mesh * glm::vec4(position, 1.0f))));
  for (const glm::vec3& normal : mesh->normals)
    data.normals.push_back(fromGlm(glm::normalize(for_normals * normal)));
  data.indices = mesh->indices;
  const bool mirrored = glm::determinant(glm::mat3(group_from_mesh)) < 0.0f;
  if (draw.back != mirrored)
    for (std::size_t i = 0; i + 2 < data.indices.size(); i += 3)
      std::swap(data.indices[i + 1], data.indices[i + 2]);
  // Rows of texels follow those of the vertices.
  const std::size_t entries = rows->offsets[mesh->positions.size()];
  data.offsets.assign(rows->offsets.begin(),
                      rows->offsets.begin() + static_cast<std::ptrdiff_t>(mesh->positions.size()) + 1);
  rows->samples.resize(entries);
  rows->weights.resize(entries);
  data.samples = std::move(rows->samples);
  data.weights = std::move(rows->weights);
  return data;
}

Expected<std::vector<float>> Bundle::transfer(std::uint32_t group, std::uint32_t block) const {
  const bundle::Description& description = file_->description();
  if (group >= description.groups.size()) return file_->noSuch("group", group, description.groups.size());
  const std::vector<bundle::Cell>& cells = description.groups[group].cells;
  std::uint32_t c = 0, t = block;  // blocks are numbered cell by cell
  while (c < cells.size() && t >= cells[c].transfers.size())
    t -= static_cast<std::uint32_t>(cells[c++].transfers.size());
  if (c == cells.size()) return file_->noSuch("block", block, file_->groups[group].blocks.size());
  const bundle::CellTransfer& coded = cells[c].transfers[t];
  const auto place = std::tuple(bundle::GroupIndex(group), bundle::CellIndex(c), bundle::TransferIndex(t));
  const Result<bundle::CellCodebook> codebook =
      std::apply([&](auto... at) { return file_->reader.readCodebook(at...); }, place);
  if (!codebook) return failureOf(codebook.error());
  std::vector<std::vector<std::uint32_t>> planes;
  for (std::uint32_t p = 0; p < coded.planes.size(); ++p) {
    Result<std::vector<std::uint32_t>> plane =
        std::apply([&](auto... at) { return file_->reader.readPlane(at..., bundle::PlaneIndex(p)); }, place);
    if (!plane) return failureOf(plane.error());
    planes.push_back(std::move(*plane));
  }
  return transfer::decodeTransfer(coded.shape, codebook->codebook, codebook->cluster_of, planes);
}

namespace {

// Adds the light of a sample, whose transfer begins at `values`, to `outputs`: by its last channels if
// `full`, else by its first ones.
void addLight(const TransferBlock& block, const float* values, const LightVector& light, bool full,
              std::span<glm::vec3> outputs) {
  const std::size_t channels =
      full && block.full_channels > 0 ? block.full_channels : block.shadowed_channels;
  const std::size_t first = full && block.full_channels > 0 ? block.shadowed_channels : 0;
  const std::size_t channel_size = std::size_t{block.outputs} * block.columns;
  const std::size_t columns =
      std::min<std::size_t>(std::size_t{block.order} * block.order, light.coefficients.size());
  for (std::size_t j = 0; j < block.outputs; ++j)
    for (std::size_t i = 0; i < columns; ++i) {
      const Vec3& c = light.coefficients[i];
      const auto value = [&](std::size_t channel) {
        return values[(first + (channels == 1 ? 0 : channel)) * channel_size + j * block.columns + i];
      };
      outputs[j] += glm::vec3(value(0) * c.x, value(1) * c.y, value(2) * c.z);
    }
}

}  // namespace

Expected<std::vector<Vec3>> Bundle::shade(std::uint32_t index, const LightVector& light, bool full) const {
  const Expected<SurfaceData> data = surface(index);
  if (!data) return data.failure();
  const SurfaceInfo& info = file_->surfaces[index];
  if (info.form != TransferForm::Vector && info.form != TransferForm::NormalMapped)
    return Failure{info.mesh, "is glossy: what it sends out depends on the view", {}};
  constexpr std::uint32_t kMapped = transfer::kMappedOutputs;
  const std::uint32_t outputs = info.form == TransferForm::Vector ? 1 : kMapped;
  // Light at each sample comes first, since vertices share samples.
  std::vector<glm::vec3> lit(std::size_t{file_->groups[info.group].samples} * outputs, glm::vec3(0.0f));
  const std::vector<TransferBlock>& blocks = file_->groups[info.group].blocks;
  for (std::uint32_t b = 0; b < blocks.size(); ++b) {
    const TransferBlock& block = blocks[b];
    if (block.place != TransferPlace::Surface || block.form != info.form || block.order == 0) continue;
    const Expected<std::vector<float>> values = transfer(info.group, b);
    if (!values) return values.failure();
    const std::size_t size = block.values() / std::max(block.samples, 1u);
    for (std::uint32_t s = 0; s < block.samples; ++s)
      addLight(block, values->data() + s * size, light, full,
               std::span(lit).subspan(std::size_t{block.first_sample + s} * outputs, outputs));
  }
  std::vector<Vec3> result;
  for (std::size_t v = 0; v + 1 < data->offsets.size(); ++v) {
    std::array<glm::vec3, kMapped> sum{};
    for (std::uint32_t k = data->offsets[v]; k < data->offsets[v + 1]; ++k)
      for (std::uint32_t j = 0; j < outputs; ++j)
        sum[j] += data->weights[k] * lit[std::size_t{data->samples[k]} * outputs + j];
    if (outputs == kMapped) {
      std::array<float, kMapped> y{};
      sh::unoccludedTransfer(3, library::toGlm(data->normals[v]), y);
      sum[0] *= y[0];
      for (std::uint32_t j = 1; j < kMapped; ++j) sum[0] += y[j] * sum[j];
    }
    result.push_back(fromGlm(sum[0]));
  }
  return result;
}

}  // namespace lambent
