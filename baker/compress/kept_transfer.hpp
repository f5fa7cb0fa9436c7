// Stores coded transfer as bytes in the cache (baker/cache): after a bake that was cut short, the next run
// finds the transfers that were coded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "baker/cache/key.hpp"
#include "baker/compress/cpca.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

// These structs are what the bakes of a volume and of a neighborhood hand to the bundle.

// A CodedCell holds samples that are coded together: at most 64 Ki, in the order of the grid.
struct CodedCell {
  std::uint32_t count = 0;
  glm::vec3 bounds_min{0.0f}, bounds_max{0.0f};  // group frame
  std::vector<CodedTransfer> transfers;          // as in bundle::Cell
};

// BakedVolume is bundle::VolumeGrid with its payloads as values.
struct BakedVolume {
  glm::uvec3 size{1};
  glm::mat4 group_from_grid{1.0f};
  std::uint32_t bits = 8;
  std::vector<std::byte> density;  // codes
  float density_max = 0.0f;        // m^-1
  glm::vec3 albedo{1.0f};
  float g = 0.0f;
  glm::uvec3 transfer_size{1};
  std::vector<std::uint32_t> voxels;  // one per sample, ascending
  std::vector<CodedCell> cells;
  glm::vec3 light_probe{0.0f};  // where incoming light is sampled, group frame

  // Returns the bounds of the box of voxels in the group frame.
  std::pair<glm::vec3, glm::vec3> bounds() const {
    glm::vec3 low(group_from_grid[3]), high = low;
    for (int corner = 1; corner < 8; ++corner) {
      const glm::vec3 at = glm::vec3(size) * glm::vec3(corner & 1, corner >> 1 & 1, corner >> 2);
      const glm::vec3 place(group_from_grid * glm::vec4(at, 1.0f));
      low = glm::min(low, place), high = glm::max(high, place);
    }
    return {low, high};
  }
};

// BakedNeighborhood is bundle::NeighborhoodGrid with its payloads as values.
struct BakedNeighborhood {
  glm::uvec3 size{2};
  glm::vec3 bounds_min{0.0f}, bounds_max{0.0f};  // group frame
  std::vector<CodedCell> cells;
};

template <>
inline constexpr bool kPlainBytes<transfer::AxisCode> = sizeof(transfer::AxisCode) == 2 * sizeof(float);
template <>
inline constexpr auto kKeptMembers<transfer::SharedCodebook> =
    std::tuple(&transfer::SharedCodebook::axis_counts, &transfer::SharedCodebook::axes,
               &transfer::SharedCodebook::value_scales, &transfer::SharedCodebook::basis_scales,
               &transfer::SharedCodebook::mean_scale, &transfer::SharedCodebook::basis,
               &transfer::SharedCodebook::means, &transfer::SharedCodebook::directions);
template <>
inline constexpr auto kKeptMembers<CodedPlane> = std::tuple(&CodedPlane::bits, &CodedPlane::variance,
                                                            &CodedPlane::codes);
template <>
inline constexpr auto kKeptMembers<CodedTransfer> = std::tuple(&CodedTransfer::shape, &CodedTransfer::error,
                                                               &CodedTransfer::codebook,
                                                               &CodedTransfer::cluster_of,
                                                               &CodedTransfer::planes);
template <>
inline constexpr auto kKeptMembers<CodedCell> = std::tuple(&CodedCell::count, &CodedCell::bounds_min,
                                                           &CodedCell::bounds_max, &CodedCell::transfers);

template <>
inline constexpr auto kKeptMembers<BakedNeighborhood> = std::tuple(&BakedNeighborhood::size,
                                                                   &BakedNeighborhood::bounds_min,
                                                                   &BakedNeighborhood::bounds_max,
                                                                   &BakedNeighborhood::cells);

// Codes transfers that belong together, one after the other, on one thread.
class CachedCoding {
 public:
  explicit CachedCoding(const BakeContext& context) : context_(context) {}

  bool stopped() const { return context_.stopped(); }
  // Does what codeTransfer does; clusters and axes of the settings are those that it chooses.
  CodedTransfer code(std::span<const float> vectors, std::size_t count, const transfer::TransferShape& shape,
                     const CodingSettings& settings);
  // Removes the entries, once the result that all of them led to is kept.
  void drop();

 private:
  BakeContext context_;
  std::vector<Key> kept_;
};

}  // namespace lambent::baker
