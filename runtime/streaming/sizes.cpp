#include "runtime/streaming/sizes.hpp"

#include <algorithm>

#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/gpu/arena.hpp"

namespace lambent::streaming {

namespace {

std::uint64_t vertexBytes(const bundle::DracoAttributes& attributes) {
  std::uint64_t bytes = 12;
  if (attributes.normal >= 0) bytes += 12;
  if (attributes.texcoord0 >= 0) bytes += 8;
  if (attributes.texcoord1 >= 0) bytes += 8;
  if (attributes.color0 >= 0) bytes += 8;
  if (attributes.tangent >= 0) bytes += 16;
  return bytes;
}

}  // namespace

std::uint64_t planeBytes(const bundle::WeightPlane& plane) {
  constexpr std::uint64_t kBlock = gpu::Arena::kAlignment;
  const std::uint64_t bytes = std::uint64_t{plane.count} * plane.bits / 8;
  return std::max((bytes + kBlock - 1) / kBlock * kBlock, kBlock);
}

std::uint64_t codebookBytesOnGpu(const bundle::CellTransfer& transfer, std::uint32_t sample_count) {
  const std::uint64_t vectors = std::uint64_t{transfer.clusters} + transfer.axes;
  return 4 * (2ull * transfer.clusters + vectors * (2 + transfer.shape.size()) + sample_count);
}

std::uint64_t cellBytes(const bundle::Cell& cell) {
  std::uint64_t bytes = cell.light_probes.size() > 1 ? 4ull * kLightWeightWords * cell.sample_count : 0;
  for (const bundle::CellTransfer& transfer : cell.transfers) {
    bytes += codebookBytesOnGpu(transfer, cell.sample_count);
    for (const bundle::WeightPlane& plane : transfer.planes) bytes += planeBytes(plane);
  }
  return bytes;
}

std::uint64_t samplesOf(const bundle::Group& group) {
  std::uint64_t count = 0;
  for (const bundle::Cell& cell : group.cells) count += std::uint64_t{cell.outputs()} * cell.sample_count;
  return count;
}

std::uint64_t irradianceBytes(std::uint32_t side) {
  std::uint64_t bytes = 0;
  for (std::uint64_t level = side; level > 0; level /= 2) bytes += 8 * level * level;
  return bytes;
}

std::uint64_t volumeBytes(const bundle::VolumeGrid& grid, std::uint64_t sample_count) {
  return densityBytes(grid.size) + 4 * sample_count;
}

std::uint64_t volumeLightBytes(const bundle::Group& group) {
  if (!group.volume || group.cells.empty()) return 0;
  const glm::uvec3& size = group.volume->transfer_size;
  return std::uint64_t{8} * size.x * size.y * size.z * group.cells.front().outputs();
}

std::uint64_t proxyLodBytes(const bundle::Description& description, bundle::GroupIndex group) {
  const std::int32_t payload = description.groups[group.value].proxy;
  if (payload < 0) return 0;
  // A payload has at least emission, corners, light and flags of each triangle (docs/format.md).
  constexpr std::uint64_t kStoredBytes = 12 + 6 + 2 + 1;
  const std::uint64_t stored =
      description.payloads[static_cast<std::size_t>(payload)].raw_length / kStoredBytes;
  return kProxyLodGroupBytes +
         kProxyLodTriangleBytes * std::min<std::uint64_t>(stored, bundle::kMaxProxyTriangles);
}

Needs needsOf(const bundle::Description& description) {
  constexpr std::uint64_t kSlack = gpu::Arena::kAlignment;
  Needs needs;
  for (const bundle::Mesh& mesh : description.meshes)
    for (const bundle::Primitive& primitive : mesh.primitives)
      needs.geometry +=
          vertexBytes(primitive.attributes) * primitive.vertex_count + 4ull * primitive.index_count + kSlack;
  for (const bundle::Group& group : description.groups) {
    needs.samples += 16 * samplesOf(group);
    for (const bundle::Cell& cell : group.cells) needs.transfer += cellBytes(cell) + kSlack;
    if (group.volume)
      needs.volumes += volumeBytes(*group.volume, group.sample_count) + volumeLightBytes(group);
  }
  for (const bundle::Draw& draw : description.draws) {
    const std::uint64_t vertices = description.meshes[draw.mesh].primitives[draw.primitive].vertex_count;
    needs.rows += description.payloads[draw.rows].raw_length + 6 * vertices + 3 * kSlack;
    needs.textures += irradianceBytes(draw.texels);
    if (!draw.glossy())
      needs.radiance +=
          4ull * vertexWords(draw.form(), bundle::isLayered(description, draw)) * vertices + kSlack;
  }
  return needs;
}

}  // namespace lambent::streaming
