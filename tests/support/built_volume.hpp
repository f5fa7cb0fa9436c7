// Makes volumes with known answers: density and transfer are functions of the place, stored in a bundle's
// description as the baker would, or in parts as the loader delivers them.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/bundle/container.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/streaming/loader.hpp"
#include "tests/support/frame/bundle_store.hpp"

namespace lambent::testing {

struct BuiltVolume {
  glm::uvec3 size{8};
  // The default is a cube of 2 m about the group's origin.
  glm::mat4 group_from_grid = glm::scale(glm::translate(glm::mat4(1.0f), glm::vec3(-1.0f)), glm::vec3(0.25f));
  std::function<float(const glm::vec3& grid)> density = [](const glm::vec3&) { return 1.0f; };  // m^-1
  float density_max = 1.0f;
  std::uint32_t bits = 16;
  glm::vec3 albedo{1.0f};
  float g = 0.0f;
  glm::uvec3 transfer_size{4};
  std::function<bool(std::uint32_t voxel)> has_sample = [](std::uint32_t) { return true; };
  transfer::TransferShape shape{.order = 3};
  // Returns the shape.size() transfer values of a voxel. The default is unoccluded light.
  std::function<std::vector<float>(std::uint32_t voxel)> transfer;
  glm::quat rest_rotation{1.0f, 0.0f, 0.0f, 0.0f};
  glm::vec3 rest_translation{0.0f};
  std::int32_t node = -1, within = -1;

  std::vector<float> transferOf(std::uint32_t voxel) const {
    if (transfer) return transfer(voxel);
    std::vector<float> open(shape.size(), 0.0f);
    const std::size_t columns = shape.columns();
    if (shape.isVisibility())
      open[0] = 3.54490770f;
    else if (shape.outputs == 1)
      for (std::uint32_t c = 0; c < shape.channels(); ++c) open[c * columns] = 0.282094792f;
    else
      for (std::uint32_t c = 0; c < shape.channels(); ++c)
        for (std::uint32_t j = 0; j < shape.outputs && j < columns; ++j)
          open[(std::size_t{c} * shape.outputs + j) * columns + j] = 1.0f;
    return open;
  }
  std::vector<std::uint32_t> voxels() const {
    std::vector<std::uint32_t> list;
    for (std::uint32_t v = 0; v < transfer_size.x * transfer_size.y * transfer_size.z; ++v)
      if (has_sample(v)) list.push_back(v);
    return list;
  }
  std::vector<std::byte> codes() const {
    std::vector<std::byte> bytes;
    const float largest = bits == 16 ? 65535.0f : 255.0f;
    for (std::uint32_t z = 0; z < size.z; ++z)
      for (std::uint32_t y = 0; y < size.y; ++y)
        for (std::uint32_t x = 0; x < size.x; ++x) {
          const float value = density(glm::vec3(x, y, z) + 0.5f);
          const auto code = static_cast<std::uint32_t>(
              density_max > 0.0f ? std::lround(std::min(value / density_max, 1.0f) * largest) : 0);
          bytes.push_back(static_cast<std::byte>(code & 0xff));
          if (bits == 16) bytes.push_back(static_cast<std::byte>(code >> 8));
        }
    return bytes;
  }
  // Has one cluster, without axes, for each distinct vector.
  struct Clusters {
    transfer::Codebook codebook;
    std::vector<std::uint32_t> of_sample;
  };
  Clusters clusters() const {
    Clusters found;
    std::map<std::vector<float>, std::uint32_t> numbers;
    for (const std::uint32_t voxel : voxels()) {
      const std::vector<float> vector = transferOf(voxel);
      const auto [place, fresh] = numbers.try_emplace(vector, static_cast<std::uint32_t>(numbers.size()));
      found.of_sample.push_back(place->second);
      if (!fresh) continue;
      found.codebook.axis_counts.push_back(0);
      found.codebook.vectors.insert(found.codebook.vectors.end(), vector.begin(), vector.end());
    }
    return found;
  }
};

// Appends the volume's group and returns its index. Blob i becomes view i.
inline std::uint32_t addVolume(bundle::Description& description, std::vector<bundle::Blob>& blobs,
                               const BuiltVolume& volume) {
  Store store{description, blobs};
  const std::vector<std::uint32_t> voxels = volume.voxels();
  const auto samples = static_cast<std::uint32_t>(voxels.size());
  bundle::Group group;
  group.name = "volume";
  group.node = volume.node;
  group.within = volume.within;
  group.rest_rotation = volume.rest_rotation;
  group.rest_translation = volume.rest_translation;
  group.bounds_min = glm::vec3(1e30f);
  group.bounds_max = glm::vec3(-1e30f);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 at = glm::vec3(volume.size) * glm::vec3(corner & 1, corner >> 1 & 1, corner >> 2);
    const glm::vec3 place(volume.group_from_grid * glm::vec4(at, 1.0f));
    group.bounds_min = glm::min(group.bounds_min, place);
    group.bounds_max = glm::max(group.bounds_max, place);
  }
  group.light_probes = {0.5f * (group.bounds_min + group.bounds_max)};
  group.sample_count = samples;
  group.volume =
      bundle::VolumeGrid{.size = volume.size,
                         .group_from_grid = volume.group_from_grid,
                         .density = store.payload(bundle::PayloadType::Density, volume.codes()),
                         .bits = volume.bits,
                         .density_max = volume.density_max,
                         .albedo = volume.albedo,
                         .g = volume.g,
                         .transfer_size = volume.transfer_size,
                         .voxels = store.payload(bundle::PayloadType::Voxels, bundle::encodeVoxels(voxels))};
  const BuiltVolume::Clusters clusters = volume.clusters();
  bundle::Cell cell;
  cell.domain = transfer::Domain::Voxel;
  cell.sample_count = samples;
  cell.bounds_min = group.bounds_min;
  cell.bounds_max = group.bounds_max;
  bundle::CellTransfer transfer;
  transfer.shape = volume.shape;
  transfer.clusters = static_cast<std::uint32_t>(clusters.codebook.clusters());
  transfer.codebook =
      store.payload(bundle::PayloadType::Codebook, transfer::encodeCodebook(clusters.codebook));
  if (transfer.clusters > 1)
    transfer.cluster_ids = static_cast<std::int32_t>(store.payload(
        bundle::PayloadType::ClusterIds, transfer::encodeClusterIds(clusters.of_sample, transfer.clusters)));
  cell.transfers.push_back(std::move(transfer));
  group.cells.push_back(std::move(cell));
  description.groups.push_back(std::move(group));
  return static_cast<std::uint32_t>(description.groups.size() - 1);
}

// Returns density, voxels and codebook as the loader delivers them.
inline std::vector<streaming::Ready> partsOf(const BuiltVolume& volume, std::uint32_t index) {
  const bundle::GroupIndex group{index};
  const BuiltVolume::Clusters clusters = volume.clusters();
  std::vector<std::uint32_t> positions =
      transfer::positionsOf(clusters.of_sample, static_cast<std::uint32_t>(clusters.codebook.clusters()));
  for (std::uint32_t& position : positions) position |= clusters.of_sample[position] << 16;
  const std::vector<std::byte> codes = volume.codes();
  return {streaming::DensityChunk{{group}, codes, streaming::blockMaxima(codes, volume.bits, volume.size)},
          streaming::VoxelsChunk{{group}, volume.voxels()},
          streaming::CodebookChunk{{group, {}, {}}, clusters.codebook, std::move(positions)}};
}

}  // namespace lambent::testing
