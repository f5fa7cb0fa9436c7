// Indices into a bundle's description. Each kind is a type of its own, because groups, cells, transfers and
// planes are named side by side, and numbers in the wrong order would compile. They are no indices into the
// residency's tables either, which hold the groups and cells of all bundles.
#pragma once

#include <compare>
#include <cstdint>

namespace lambent::bundle {

template <class Kind>
struct Index {
  constexpr Index() = default;
  explicit constexpr Index(std::uint32_t index) : value(index) {}
  friend constexpr auto operator<=>(const Index&, const Index&) = default;

  std::uint32_t value = 0;
};

using GroupIndex = Index<struct GroupKind>;        // into Description::groups
using CellIndex = Index<struct CellKind>;          // into Group::cells
using TransferIndex = Index<struct TransferKind>;  // into Cell::transfers
using PlaneIndex = Index<struct PlaneKind>;        // into CellTransfer::planes

}  // namespace lambent::bundle
