#include "runtime/evaluate/samples.hpp"

#include <algorithm>
#include <bit>
#include <span>

#include <fmt/format.h>

#include "lambent_evaluate_embedded.hpp"
#include "lambent_transfer_embedded.hpp"
#include "runtime/sh/gaunt.hpp"

namespace lambent::evaluate {

const gpu::FindText kEvaluateShaders[2] = {&embedded::lambent_evaluate::find,
                                           &embedded::lambent_transfer::find};

static_assert(transfer::kLightStride == lighting::GroupLights::kStride &&
              transfer::kMaxWorkGroupsX == gpu::WorkList::kMaxGroupsX);

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
  Cell& range = cells.emplace_back(Cell{.first = static_cast<std::uint32_t>(transfers.size()), .count = 0});
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
      places.push_back(transfer.planes[j].block.word() |
                       (transfer.planes[j].bits == 16 ? transfer::kCodes16Bit : 0u));
    record.first_product = product_count;
    product_count += record.light_count * record.light_products;
    transfers.push_back(record);
  }
}

namespace {

// Returns the newest version of the light on the cell.
std::uint64_t lightVersion(const lighting::GroupLights& lights, const streaming::ResidentCell& cell) {
  std::uint64_t version = lights.lampsVersionOf(cell.group);
  for (const std::uint32_t sample : cell.light_probes)
    version = std::max(version, lights.versionOf(cell.group, sample));
  return version;
}

transfer::FillRecord describeFill(const streaming::ResidentGroup& group, const streaming::ResidentCell& cell,
                                  std::uint32_t light) {
  const bool open = cell.domain != transfer::Domain::GridPoint;
  return {.first_output = cell.first_output,
          .output_count = cell.outputs * cell.sample_count,
          .outputs = cell.outputs,
          .light = light,
          .coefficients = open ? group.order * group.order : 0,
          .open = open ? 1u : 0u};
}

// Tells which kernel shades the samples of a batch.
constexpr std::uint32_t kOneLight = 0, kSeveralLights = 1, kMatrices = 2;

}  // namespace

std::vector<std::uint32_t> gauntWords(std::uint32_t bands_in, std::uint32_t bands_out) {
  const sh::GauntTable table = sh::makeGauntTable(static_cast<int>(bands_in), static_cast<int>(bands_out));
  std::vector<std::uint32_t> words(table.offsets.begin(), table.offsets.end());
  for (const sh::GauntTerm& term : table.terms) {
    words.push_back(term.j | std::uint32_t{term.k} << 16);
    words.push_back(std::bit_cast<std::uint32_t>(term.value));
  }
  return words;
}

Samples::Samples()
    : kernels_(kEvaluateShaders),
      transfers_table_("transfers"),
      places_table_("transfer places"),
      products_("transfer products"),
      fills_table_("sample fills"),
      works_{Work("work on vectors"), Work("work on matrices")} {}

Result<void> Samples::shade(streaming::Residency& residency, const lighting::GroupLights& lights,
                            TransferMode mode, gpu::Counters& counters, const ShadedKinds& kinds) {
  const bool other_way = way_changed_.renew(mode, lights.hasKeys(), lights.hasPartedLamps());
  if (other_way) cells_changed_.clear();  // shades everything anew
  if (layout_changed_.renew(residency.version(), lights.groupCount()) || other_way)
    rebuildTables(residency, lights, mode);
  collect(residency, lights, kinds);
  if (cells_shaded_ == 0) return {};
  lights.bindStorage(transfer::kBindLights);
  for (Work& work : works_)
    if (Result<void> done = runWork(work, residency, counters); !done) return done;
  return {};
}

Result<void> Samples::runWork(Work& work, streaming::Residency& residency, gpu::Counters& counters) {
  fills_table_.bindStorage(transfer::kBindFills);
  Result<void> done = run(work.fill, counters, [&](const gpu::BatchKey& key) {
    residency.samples().page(key[0]).bindStorage(transfer::kBindSamples);
    return kernels_.use("fill_samples.comp");
  });
  if (!done) return done;
  transfers_table_.bindStorage(transfer::kBindTransfers);
  places_table_.bindStorage(transfer::kBindPlaces);
  products_.bindStorage(transfer::kBindProducts);
  done = project(work.project, residency, counters);
  for (std::size_t i = 0; i < work.samples.size() && done; ++i)
    done = run(work.samples[i], counters, [&](const gpu::BatchKey& key) {
      residency.transfer().page(key[2]).bindStorage(transfer::kBindTransfer);
      residency.samples().page(key[3]).bindStorage(transfer::kBindSamples);
      if (key[1] == kMatrices)
        return kernels_.use(
            "shade_samples.comp",
            {{"LAMBENT_MATRICES", "1"}, {"LAMBENT_BANDS", fmt::format("{}u", transfer::bandsOf(key[0]))}});
      std::vector<gpu::Define> defines = {{"LAMBENT_OUTPUTS", std::to_string(key[0])}};
      if (key[1] == kSeveralLights) defines.push_back({"LAMBENT_MANY_LIGHTS", "1"});
      return kernels_.use("shade_samples.comp", std::move(defines));
    });
  return done;
}

void Samples::rebuildTables(const streaming::Residency& residency, const lighting::GroupLights& lights,
                            TransferMode mode) {
  tables_ = {};
  fills_.clear();
  for (const streaming::ResidentCell& cell : residency.cells()) {
    fills_.push_back(describeFill(residency.groups()[cell.group], cell, lights.firstOf(cell.group)));
    tables_.add(cell, lights, mode);
  }
  transfers_table_.assign(std::span<const transfer::TransferRecord>(tables_.transfers));
  places_table_.assign(std::span<const std::uint32_t>(tables_.places));
  fills_table_.assign(std::span<const transfer::FillRecord>(fills_));
  products_.reserve(tables_.product_count * sizeof(glm::vec4));
  cells_changed_.follow(residency.cells(), &streaming::ResidentCell::id);
  versions_.follow(residency.groups(), &streaming::ResidentGroup::id);
}

void Samples::collect(const streaming::Residency& residency, const lighting::GroupLights& lights,
                      const ShadedKinds& kinds) {
  cells_shaded_ = 0;
  for (Work& work : works_) {
    work.fill.clear();
    work.project.clear();
    for (gpu::WorkList& list : work.samples) list.clear();
  }
  for (std::uint32_t i = 0; i < tables_.cells.size(); ++i) {
    const streaming::ResidentCell& cell = residency.cells()[i];
    const TransferTable::Cell range = tables_.cells[i];
    const bool open = range.count == 0 || !cell.usable(), matrices = cell.matrices();
    if (!kinds.has(cell) || (open && !matrices)) continue;
    const std::uint64_t light = open ? lights.versionOf(cell.group, 0) : lightVersion(lights, cell);
    if (!cells_changed_[i].renew(cell.version, light)) continue;
    ++(matrices ? versions_[cell.group].matrices : versions_[cell.group].vectors);
    ++cells_shaded_;
    Work& work = works_[matrices ? 1 : 0];
    const std::uint32_t samples_page = residency.groups()[cell.group].samples.page;
    if (open) {
      work.fill.add({samples_page}, i, fills_[i].output_count, transfer::kWorkGroupSize);
      continue;
    }
    for (std::uint32_t t = range.first; t < range.first + range.count; ++t) {
      const transfer::TransferRecord& record = tables_.transfers[t];
      const bool visibility = record.visibility != 0;
      work.project.add({visibility ? 1u : 0u, visibility ? record.order : compiledOrder(record.order),
                        record.outputs, cell.block.page},
                       t, record.light_count * record.clusters * record.outputs, transfer::kUnitsPerGroup);
      const std::uint32_t kernel = matrices ? kMatrices : record.light_count > 1 ? kSeveralLights : kOneLight;
      const std::uint32_t invocations = matrices ? transfer::bandsOf(record.outputs) : 1;
      work.samples[std::min<std::size_t>(t - range.first, kMaxTransfers - 1)].add(
          {record.outputs, kernel, cell.block.page, samples_page}, t, invocations * record.sample_count,
          transfer::kWorkGroupSize);
    }
  }
}

Result<void> Samples::project(gpu::WorkList& work, streaming::Residency& residency, gpu::Counters& counters) {
  return run(work, counters, [&](const gpu::BatchKey& key) {
    residency.transfer().page(key[3]).bindStorage(transfer::kBindTransfer);
    if (key[0] != 0) {
      const std::uint32_t bands = transfer::bandsOf(key[2]);
      gpu::Table& gaunt = gaunts_.try_emplace({key[1], bands}, "products of harmonics").first->second;
      if (!gaunt.buffer()) gaunt.assign(std::span<const std::uint32_t>(gauntWords(key[1], bands)));
      gaunt.bindStorage(transfer::kBindGaunt);
      return kernels_.use("project_clusters.comp", {{"LAMBENT_VISIBILITY", "1"}});
    }
    std::vector<gpu::Define> defines;
    if (key[1] != 0) defines.push_back({"LAMBENT_ORDER", fmt::format("{}u", key[1])});
    return kernels_.use("project_clusters.comp", std::move(defines));
  });
}

}  // namespace lambent::evaluate
