#include "runtime/evaluate/transfer_values.hpp"

#include <algorithm>
#include <utility>

#include "runtime/evaluate/samples.hpp"

namespace lambent::evaluate {

TransferValues::TransferValues()
    : cells_("transfer value cells"),
      transfers_("transfer value transfers"),
      places_("transfer value places"),
      work_("transfer value work"),
      adding_work_("transfer value adding work") {}

Result<void> TransferValues::update(streaming::Residency& residency, const lighting::GroupLights& lights,
                                    const TransferQuestion& question, std::span<const float> of_cells,
                                    const GiveValues& give, gpu::Counters& counters) {
  if (!changed_.renew(question, residency.version(), lights.groupCount())) return {};
  question_ = question;
  describe(residency, lights, of_cells);
  if (question.value == TransferValue::Given) {
    const Result<std::vector<SampleValue>> given = give();
    if (!given) return failAgain(given.error());
    values_.write(0, std::span<const SampleValue>(*given));
    return {};
  }
  const SampleValue nothing{.value_bits = 0, .cluster = kNoCluster};
  glClearNamedBufferData(values_.id(), GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT, &nothing);
  if (Result<void> done = run(residency, work_, counters); !done) return done;
  return run(residency, adding_work_, counters);
}

void TransferValues::describe(const streaming::Residency& residency, const lighting::GroupLights& lights,
                              std::span<const float> of_cells) {
  first_of_group_.clear();
  std::uint32_t sample_count = 0;
  for (const streaming::ResidentGroup& group : residency.groups()) {
    first_of_group_.push_back(sample_count);
    for (std::uint32_t c = group.first_cell; c < group.first_cell + group.cell_count; ++c)
      if (residency.cells()[c].domain == transfer::Domain::Vertex)
        sample_count += residency.cells()[c].sample_count;
  }
  TransferTable table;
  std::vector<ValueCell> cells;
  work_.clear();
  adding_work_.clear();
  for (std::uint32_t i = 0; i < residency.cells().size(); ++i) {
    const streaming::ResidentCell& cell = residency.cells()[i];
    table.add(cell, lights, question_.mode);
    if (cell.domain != transfer::Domain::Vertex || !cell.usable()) continue;
    const TransferTable::Cell range = table.cells.back();
    for (std::uint32_t t = range.first; t < range.first + range.count; ++t) {
      const transfer::TransferRecord& record = table.transfers[t];
      if (record.order == 0) continue;  // the group's own lights
      const bool adds = record.accumulate != 0;
      if (adds && question_.value != TransferValue::Dc) continue;
      const auto at = static_cast<std::uint32_t>(cells.size());
      cells.push_back({.transfer = t,
                       .first_value = first_of_group_[cell.group] + cell.first_sample,
                       .cell = i,
                       .constant = i < of_cells.size() ? of_cells[i] : 0.0f});
      (adds ? adding_work_ : work_).add({cell.block.page}, at, record.sample_count, transfer::kWorkGroupSize);
    }
  }
  cells_.assign(std::span<const ValueCell>(cells));
  transfers_.assign(std::span<const transfer::TransferRecord>(table.transfers));
  places_.assign(std::span<const std::uint32_t>(table.places));
  const std::size_t bytes = std::max<std::size_t>(sample_count, 1) * sizeof(SampleValue);
  if (values_.byteCount() != bytes) values_ = gpu::Buffer("transfer values", bytes);
}

Result<void> TransferValues::run(streaming::Residency& residency, gpu::WorkList& work,
                                 gpu::Counters& counters) {
  cells_.bindStorage(kBindValueCells);
  transfers_.bindStorage(transfer::kBindTransfers);
  places_.bindStorage(transfer::kBindPlaces);
  values_.bindStorage(kBindValues);
  return evaluate::run(work, counters, [&](const gpu::BatchKey& key) {
    residency.transfer().page(key[0]).bindStorage(transfer::kBindTransfer);
    const bool dc = question_.value == TransferValue::Dc;
    return kernels_.use("transfer_values.comp", {{"LAMBENT_VALUE", dc ? "1" : "0"}});
  });
}

}  // namespace lambent::evaluate
