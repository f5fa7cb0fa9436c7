#include "runtime/evaluate/transfer_table.hpp"

#include <algorithm>

#include "lambent_evaluate_embedded.hpp"
#include "lambent_transfer_embedded.hpp"

namespace lambent::evaluate {

const gpu::FindText kEvaluateShaders[2] = {&embedded::lambent_evaluate::find,
                                           &embedded::lambent_transfer::find};

namespace {

bool takesFull(const transfer::TransferShape& shape, TransferMode mode) {
  return mode == TransferMode::Full && shape.full_channels > 0;
}

// Bounced light with a transfer of its own does not count in light without bounces.
bool takesAny(const transfer::TransferShape& shape, TransferMode mode) {
  return takesFull(shape, mode) || (mode != TransferMode::Unshadowed && shape.shadowed_channels > 0);
}

// Only surfaces see the group's own lights per pixel. Grids around bodies carry all of their light, because
// what receives it there has no shadow cube of it.
bool takesPartedLamps(const streaming::ResidentCell& cell, const lighting::GroupLights& lights) {
  return lights.hasPartedLamps() && cell.domain == transfer::Domain::Vertex;
}

transfer::TransferRecord describeTransfer(const streaming::ResidentCell& cell,
                                          const streaming::ResidentTransfer& transfer, TransferMode mode,
                                          const lighting::GroupLights& lights) {
  const transfer::TransferShape& shape = transfer.shape;
  const bool full = takesFull(shape, mode);
  const bool apart = shape.order > 0 ? lights.hasKeys() : takesPartedLamps(cell, lights);
  const bool several = shape.order > 0 && cell.light_probes.size() > 1;
  return {.light_count = several ? static_cast<std::uint32_t>(cell.light_probes.size()) : 1,
          .first_light = 0,
          .light_weights_word = cell.light_weights_word,
          .columns = shape.columns(),
          .channels = full ? shape.full_channels : shape.shadowed_channels,
          .outputs = shape.outputs,
          .clusters = transfer.clusters,
          .clusters_word = transfer.clusters_word,
          .weights_word = transfer.weights_word,
          .vectors_word = transfer.vectors_word,
          .positions_word = transfer.positions_word,
          .vector_size = shape.size(),
          .first_value = full ? shape.shadowed_channels * shape.outputs * shape.columns() : 0,
          .plane_count = transfer.planes_resident,
          .first_plane = 0,
          .first_product = 0,
          .light_products = (transfer.clusters + transfer.axes) * shape.outputs,
          .first_output = cell.first_output,
          .sample_count = cell.sample_count,
          .accumulate = 0,
          .order = shape.order,
          .visibility = shape.isVisibility() ? 1u : 0u,
          .bounced = full && apart ? 1u : 0u,
          .straight_channels = apart ? shape.shadowed_channels : 0,
          .apart = shape.order > 0 ? lighting::GroupLights::kBlock : shape.light_columns,
          .pad = 0};
}

}  // namespace

void TransferTable::add(const streaming::ResidentCell& cell, const lighting::GroupLights& lights,
                        TransferMode mode) {
  addNone();
  Cell& range = cells.back();
  for (const streaming::ResidentTransfer& transfer : cell.transfers) {
    if (!takesAny(transfer.shape, mode) || !transfer.codebook_resident) continue;
    transfer::TransferRecord record = describeTransfer(cell, transfer, mode, lights);
    record.accumulate = range.count++ > 0 ? 1 : 0;
    record.first_light = static_cast<std::uint32_t>(places.size());
    if (transfer.shape.order == 0) {
      places.push_back(takesPartedLamps(cell, lights) ? lights.partedLampsOf(cell.group)
                                                      : lights.lampsOf(cell.group));
    } else {
      for (const std::uint32_t sample : cell.light_probes)
        places.push_back(lights.firstOf(cell.group, sample));
    }
    record.first_plane = static_cast<std::uint32_t>(places.size());
    for (std::uint32_t j = 0; j < transfer.planes_resident; ++j)
      places.push_back(transfer.planes[j].word |
                       (transfer.planes[j].bits == 16 ? transfer::kCodes16Bit : 0u));
    record.first_product = product_count;
    product_count += record.light_count * record.light_products;
    transfers.push_back(record);
  }
}

std::uint64_t lightVersion(const lighting::GroupLights& lights, const streaming::ResidentCell& cell) {
  std::uint64_t version = lights.lampsVersionOf(cell.group);
  for (const std::uint32_t sample : cell.light_probes)
    version = std::max(version, lights.versionOf(cell.group, sample));
  return version;
}

}  // namespace lambent::evaluate
