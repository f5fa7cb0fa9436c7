// The transfers of cells as the kernels of all effects read them (diffuse_shared.h): records, and the places
// of planes and lights that they refer to.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/effects/diffuse/diffuse_shared.h"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/streaming/residency.hpp"

namespace lambent::effects::diffuse {

// Which block of the transfer counts: none, light without bounces, all light where it was baked. Unshadowed,
// the groups' own lights are dark: without transfer there is no telling where their light goes.
enum class TransferMode { Unshadowed, Shadowed, Full };

// Whose samples are shaded; what is left out keeps what it last had, and catches up when it is asked for.
struct ShadedKinds {
  bool surfaces = true, volumes = true, neighborhoods = true;

  bool has(bundle::CellKind kind) const {
    return kind == bundle::CellKind::Surface  ? surfaces
           : kind == bundle::CellKind::Volume ? volumes
                                              : neighborhoods;
  }
};

struct TransferTable {
  struct Cell {
    std::uint32_t first = 0, count = 0;  // into transfers
  };
  std::vector<Cell> cells;  // index: residency cell
  std::vector<TransferRecord> transfers;
  std::vector<std::uint32_t> places;  // of their planes and lights
  std::uint32_t product_count = 0;

  // The cell's transfers as far as they are resident; those without anything for the mode are left out.
  void add(const streaming::ResidentCell& cell, const lighting::GroupLights& lights, TransferMode mode);
  // A cell that another effect shades.
  void addNone() { cells.push_back({.first = static_cast<std::uint32_t>(transfers.size()), .count = 0}); }
};

// Newest of what the cell is lit by.
std::uint64_t lightVersion(const lighting::GroupLights& lights, const streaming::ResidentCell& cell);

}  // namespace lambent::effects::diffuse
