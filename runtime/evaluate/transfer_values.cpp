#include "runtime/evaluate/transfer_values.hpp"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "runtime/evaluate/transfer_table.hpp"
#include "runtime/sh/gaunt.hpp"

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
      const bool folded = record.visibility != 0 && question_.value == TransferValue::BandEnergy;
      (adds ? adding_work_ : work_)
          .add({folded ? record.order : 0u, cell.block.page}, at, record.sample_count,
               transfer::kWorkGroupSize);
    }
  }
  cells_.assign(std::span<const ValueCell>(cells));
  transfers_.assign(std::span<const transfer::TransferRecord>(table.transfers));
  places_.assign(std::span<const std::uint32_t>(table.places));
  const std::size_t bytes = std::max<std::size_t>(sample_count, 1) * sizeof(SampleValue);
  if (values_.byteCount() != bytes) values_ = gpu::Buffer("transfer values", bytes);
}

Result<const gpu::Program*> TransferValues::program(TransferValue value, std::uint32_t visibility) {
  const std::array<std::uint32_t, 2> variant = {static_cast<std::uint32_t>(value), visibility};
  if (const auto found = programs_.find(variant); found != programs_.end()) return &found->second;
  std::vector<gpu::Define> defines = {{"LAMBENT_VALUE", std::to_string(variant[0])}};
  if (visibility > 0) defines.push_back({"LAMBENT_VISIBILITY", std::to_string(visibility)});
  Result<gpu::Program> made =
      gpu::Program::create(fmt::format("transfer values {} visibility {}", variant[0], visibility),
                           {{GL_COMPUTE_SHADER, "transfer_values.comp"}}, kEvaluateShaders, defines);
  if (!made) return failAgain(made.error());
  return &programs_.emplace(variant, std::move(*made)).first->second;
}

// The layout is that of transfer_values.comp: offsets of the outputs, then each term's j | k << 16 and its
// value.
void TransferValues::bindProducts(std::uint32_t order) {
  gpu::Buffer& buffer = products_[order];
  if (!buffer) {
    const sh::GauntTable table = sh::makeGauntTable(static_cast<int>(order), 3);
    std::vector<std::uint32_t> words = table.offsets;
    for (const sh::GauntTerm& term : table.terms) {
      words.push_back(term.j | static_cast<std::uint32_t>(term.k) << 16);
      words.push_back(std::bit_cast<std::uint32_t>(term.value));
    }
    buffer = gpu::Buffer("transfer value products", words.size() * sizeof(std::uint32_t));
    buffer.write(0, std::span<const std::uint32_t>(words));
  }
  buffer.bindStorage(kBindProducts3);
}

Result<void> TransferValues::run(streaming::Residency& residency, gpu::WorkList& work,
                                 gpu::Counters& counters) {
  if (work.empty()) return {};
  cells_.bindStorage(kBindValueCells);
  transfers_.bindStorage(transfer::kBindTransfers);
  places_.bindStorage(transfer::kBindPlaces);
  values_.bindStorage(kBindValues);
  work.upload(counters);
  std::size_t index = 0;
  for (const auto& [key, items] : work.batches()) {
    const Result<const gpu::Program*> kernel = program(question_.value, key[0]);
    if (!kernel) return failAgain(kernel.error());
    (*kernel)->use();
    glUniform1ui(0, question_.band);
    if (key[0] > 0) bindProducts(key[0]);
    residency.transfer().page(key[1]).bindStorage(transfer::kBindTransfer);
    work.dispatch(index++, transfer::kBindWork, counters);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return {};
}

}  // namespace lambent::evaluate
