// Drops planes and transfer of groups from the GPU.
#include <optional>

#include "runtime/streaming/residency.hpp"

namespace lambent::streaming {

namespace {

ResidentGroup& groupOf(ResidentTables& tables, std::uint32_t bundle, bundle::GroupIndex group) {
  return tables.groups[tables.bundles[bundle].first.groups + group.value];
}

}  // namespace

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
