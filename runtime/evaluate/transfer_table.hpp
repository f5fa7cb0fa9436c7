// Lists the transfers of cells as the kernels of all effects read them (transfer_shared.h): the records, and
// the places of planes and lights that they refer to.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/gpu/program.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/streaming/residency.hpp"
#include "runtime/transfer/transfer_shared.h"

namespace lambent::evaluate {

// The tables of GLSL text that programs of this room include files from.
extern const gpu::FindText kEvaluateShaders[2];

// Selects the block of the transfer that counts: none, light without bounces, or all light where it was
// baked. In mode Unshadowed the groups' own lights are dark, because without transfer it is unknown where
// their light goes.
enum class TransferMode { Unshadowed, Shadowed, Full };

// Selects whose samples are shaded. Others keep their last values, and are updated when they are selected
// again.
struct ShadedKinds {
  bool surfaces = true, volumes = true, neighborhoods = true;

  bool has(transfer::Domain domain) const {
    return domain == transfer::Domain::Vertex  ? surfaces
           : domain == transfer::Domain::Voxel ? volumes
                                               : neighborhoods;
  }
};

struct TransferTable {
  struct Cell {
    std::uint32_t first = 0, count = 0;  // a range of `transfers`
  };
  std::vector<Cell> cells;  // index: residency cell
  std::vector<transfer::TransferRecord> transfers;
  std::vector<std::uint32_t> places;  // of their planes and lights
  std::uint32_t product_count = 0;

  // Adds the resident transfers of the cell, leaving out those without a block for the mode.
  void add(const streaming::ResidentCell& cell, const lighting::GroupLights& lights, TransferMode mode);
  // Adds a cell that another effect shades.
  void addNone() { cells.push_back({.first = static_cast<std::uint32_t>(transfers.size()), .count = 0}); }
};

// Returns the newest version of the light on the cell.
std::uint64_t lightVersion(const lighting::GroupLights& lights, const streaming::ResidentCell& cell);

}  // namespace lambent::evaluate
