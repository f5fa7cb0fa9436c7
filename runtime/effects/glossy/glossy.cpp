#include "runtime/effects/glossy/glossy.hpp"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "lambent_effects_glossy_embedded.hpp"
#include "lambent_transfer_embedded.hpp"
#include "runtime/sh/gaunt.hpp"

namespace lambent::effects::glossy {

using namespace transfer;  // for the bindings of the kernels

namespace {

constexpr gpu::FindText kShaders[] = {&embedded::lambent_effects_glossy::find,
                                      &embedded::lambent_transfer::find};

// Returns the order that is compiled into the dense kernel; 0 selects the kernel that loops over any order.
std::uint32_t variantOf(std::uint32_t order) {
  return order >= 2 && order <= 6 ? order : 0;
}

FillRecord describeFill(const streaming::ResidentGroup& group, const streaming::ResidentCell& cell,
                        std::uint32_t light) {
  const bool open = cell.domain != transfer::Domain::GridPoint;
  return {.first_output = cell.first_output,
          .output_count = cell.outputs * cell.sample_count,
          .outputs = cell.outputs,
          .light = light,
          .coefficients = open ? group.order * group.order : 0,
          .open = open ? 1u : 0u};
}

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

Glossy::Glossy()
    : transfers_table_("glossy transfers"),
      places_table_("glossy places"),
      products_("glossy products"),
      fills_table_("glossy fills"),
      visibility_work_("glossy visibility work"),
      dense_work_("glossy dense work"),
      fill_work_("glossy fill work"),
      samples_work_{gpu::WorkList("glossy samples work"), gpu::WorkList("glossy adding work"),
                    gpu::WorkList("glossy adding more work")} {}

Result<void> Glossy::shade(streaming::Residency& residency, const lighting::GroupLights& lights,
                           evaluate::TransferMode mode, gpu::Counters& counters,
                           const evaluate::ShadedKinds& kinds) {
  const bool other_way = way_changed_.renew(mode, lights.hasKeys(), lights.hasPartedLamps());
  if (other_way) cells_changed_.clear();  // shades everything anew
  if (layout_changed_.renew(residency.version(), lights.groupCount()) || other_way) {
    any_ = std::any_of(residency.cells().begin(), residency.cells().end(),
                       [](const streaming::ResidentCell& cell) { return cell.matrices(); });
    rebuildTables(residency, lights, mode);
  }
  cells_shaded_ = 0;
  if (!any_) return {};
  collect(residency, lights, kinds);
  if (cells_shaded_ == 0) return {};
  lights.bindStorage(transfer::kBindLights);
  if (Result<void> run = fill(residency, counters); !run) return run;
  if (Result<void> run = project(residency, counters); !run) return run;
  for (gpu::WorkList& work : samples_work_)
    if (Result<void> run = shadeSamples(residency, work, counters); !run) return run;
  return {};
}

void Glossy::rebuildTables(const streaming::Residency& residency, const lighting::GroupLights& lights,
                           evaluate::TransferMode mode) {
  tables_ = {};
  fills_.clear();
  cells_changed_.follow(residency.cells(), &streaming::ResidentCell::id);
  group_shaded_.follow(residency.groups(), &streaming::ResidentGroup::id);
  if (!any_) return;
  for (const streaming::ResidentCell& cell : residency.cells()) {
    fills_.push_back(describeFill(residency.groups()[cell.group], cell, lights.firstOf(cell.group)));
    if (cell.matrices())
      tables_.add(cell, lights, mode);
    else
      tables_.addNone();
  }
  transfers_table_.assign(std::span<const transfer::TransferRecord>(tables_.transfers));
  places_table_.assign(std::span<const std::uint32_t>(tables_.places));
  fills_table_.assign(std::span<const FillRecord>(fills_));
  products_.reserve(tables_.product_count * sizeof(glm::vec4));
}

void Glossy::collect(const streaming::Residency& residency, const lighting::GroupLights& lights,
                     const evaluate::ShadedKinds& kinds) {
  visibility_work_.clear();
  dense_work_.clear();
  fill_work_.clear();
  for (gpu::WorkList& work : samples_work_) work.clear();
  for (std::uint32_t i = 0; i < tables_.cells.size(); ++i) {
    const streaming::ResidentCell& cell = residency.cells()[i];
    if (!cell.matrices() || !kinds.has(cell.domain)) continue;
    const evaluate::TransferTable::Cell range = tables_.cells[i];
    const bool open = range.count == 0 || !cell.usable();
    const std::uint64_t light = open ? lights.versionOf(cell.group, 0) : evaluate::lightVersion(lights, cell);
    if (!cells_changed_[i].renew(cell.version, light)) continue;
    ++group_shaded_[cell.group];
    ++cells_shaded_;
    const std::uint32_t samples_page = residency.groups()[cell.group].samples.page;
    if (open) {
      fill_work_.add({samples_page}, i, fills_[i].output_count, transfer::kWorkGroupSize);
      continue;
    }
    const std::uint32_t bands = transfer::bandsOf(cell.outputs);
    for (std::uint32_t t = range.first; t < range.first + range.count; ++t) {
      const transfer::TransferRecord& record = tables_.transfers[t];
      const std::uint32_t units = record.light_count * record.clusters * record.outputs;
      if (record.visibility != 0)
        visibility_work_.add({record.order, bands, cell.block.page}, t, units, transfer::kUnitsPerGroup);
      else
        dense_work_.add({variantOf(record.order), cell.block.page}, t, units, transfer::kUnitsPerGroup);
      samples_work_[std::min<std::size_t>(t - range.first, kMaxTransfers - 1)].add(
          {bands, cell.block.page, samples_page}, t, bands * record.sample_count, transfer::kWorkGroupSize);
    }
  }
}

Result<const gpu::Program*> Glossy::program(Kernel kernel, std::uint32_t variant) {
  constexpr std::array<const char*, kKernelCount> kFiles = {"project_visibility.comp", "project_vectors.comp",
                                                            "shade_matrices.comp", "glossy_fill.comp"};
  auto& programs = programs_[kernel];
  if (const auto found = programs.find(variant); found != programs.end()) return &found->second;
  std::vector<gpu::Define> defines;
  if (variant != 0)
    defines.push_back({kernel == Samples ? "LAMBENT_BANDS" : "LAMBENT_ORDER", fmt::format("{}u", variant)});
  Result<gpu::Program> made = gpu::Program::create(fmt::format("{} {}", kFiles[kernel], variant),
                                                   {{GL_COMPUTE_SHADER, kFiles[kernel]}}, kShaders, defines);
  if (!made) return failAgain(made.error());
  return &programs.emplace(variant, std::move(*made)).first->second;
}

Result<void> Glossy::fill(streaming::Residency& residency, gpu::Counters& counters) {
  if (fill_work_.empty()) return {};
  const Result<const gpu::Program*> kernel = program(Fill, 0);
  if (!kernel) return failAgain(kernel.error());
  (*kernel)->use();
  fill_work_.upload(counters);
  fills_table_.bindStorage(kBindFills);
  std::size_t index = 0;
  for (const auto& [key, items] : fill_work_.batches()) {
    residency.samples().page(key[0]).bindStorage(transfer::kBindSamples);
    fill_work_.dispatch(index++, transfer::kBindWork, counters);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return {};
}

Result<void> Glossy::project(streaming::Residency& residency, gpu::Counters& counters) {
  transfers_table_.bindStorage(transfer::kBindTransfers);
  places_table_.bindStorage(transfer::kBindPlaces);
  products_.bindStorage(transfer::kBindProducts);
  const auto run = [&](gpu::WorkList& work, Kernel stage) -> Result<void> {
    if (work.empty()) return {};
    work.upload(counters);
    std::size_t index = 0;
    for (const auto& [key, items] : work.batches()) {
      const Result<const gpu::Program*> kernel = program(stage, stage == Visibility ? 0 : key[0]);
      if (!kernel) return failAgain(kernel.error());
      (*kernel)->use();
      residency.transfer().page(key.back()).bindStorage(transfer::kBindTransfer);
      if (stage == Visibility) {
        gpu::Table& gaunt = gaunts_.try_emplace({key[0], key[1]}, "products of harmonics").first->second;
        if (!gaunt.buffer()) gaunt.assign(std::span<const std::uint32_t>(gauntWords(key[0], key[1])));
        gaunt.bindStorage(transfer::kBindGaunt);
      }
      work.dispatch(index++, transfer::kBindWork, counters);
    }
    return {};
  };
  if (Result<void> done = run(visibility_work_, Visibility); !done) return done;
  if (Result<void> done = run(dense_work_, Dense); !done) return done;
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return {};
}

Result<void> Glossy::shadeSamples(streaming::Residency& residency, gpu::WorkList& work,
                                  gpu::Counters& counters) {
  if (work.empty()) return {};
  work.upload(counters);
  std::size_t index = 0;
  for (const auto& [key, items] : work.batches()) {
    const Result<const gpu::Program*> kernel = program(Samples, key[0]);
    if (!kernel) return failAgain(kernel.error());
    (*kernel)->use();
    residency.transfer().page(key[1]).bindStorage(transfer::kBindTransfer);
    residency.samples().page(key[2]).bindStorage(transfer::kBindSamples);
    work.dispatch(index++, transfer::kBindWork, counters);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return {};
}

}  // namespace lambent::effects::glossy
