// Shades random glossy cells on the GPU and by the kernels as C++, from the same memory.
#pragma once

#include <algorithm>
#include <vector>

#include "tests/runtime/evaluate/shading_bench.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/glsl/glossy_kernels.hpp"

namespace lambent::evaluate::testing {

struct Bench : lambent::testing::ShadingBench {
  using ShadingBench::ShadingBench;

  // Shades once and returns the number of dispatches.
  std::uint32_t shade(TransferMode mode = TransferMode::Full) {
    gpu::Counters counters;
    shadeSamples(mode, {.vectors = false}, counters);
    return counters.dispatches;
  }

  static std::vector<glm::vec4> samplesOf(gpu::Arena& arena, std::uint32_t page) {
    std::vector<glm::vec4> samples(arena.page(page).byteCount() / sizeof(glm::vec4));
    arena.page(page).read(0, std::span(samples));
    return samples;
  }

  // Returns the largest difference between a glossy sample and the C++ kernels', in RGB and visibility,
  // relative to the largest value.
  double differenceToTwin() {
    double difference = 0.0, largest = 0.0;
    const TransferTable& tables = samples.tables();
    std::vector<glm::vec4> products(tables.product_count);
    for (std::size_t i = 0; i < tables.cells.size(); ++i) {
      const streaming::ResidentCell& cell = residency.cells()[i];
      if (!cell.matrices()) continue;
      const std::vector<glm::vec4> got =
          samplesOf(residency.samples(), residency.groups()[cell.group].samples.page);
      std::vector<glm::vec4> wanted(got.size(), glm::vec4(0.0f));
      const transfer::FillRecord& fill = samples.fills()[i];
      if (tables.cells[i].count == 0 || !cell.usable()) {
        transfer::glsl::FillSamples kernel;
        kernel.lights = lights.coefficients();
        kernel.fills = std::span(&fill, 1);
        kernel.samples = wanted;
        lambent::glsl::run(kernel, fill.output_count);
      } else {
        std::vector<uint> page(residency.transfer().page(cell.block.page).byteCount() / 4);
        residency.transfer().page(cell.block.page).read(0, std::span(page));
        for (uint t = 0; t < tables.cells[i].count; ++t) {
          const transfer::TransferRecord& record = tables.transfers[tables.cells[i].first + t];
          std::vector<uint> gaunt;
          if (record.visibility != 0) gaunt = gauntWords(record.order, transfer::bandsOf(record.outputs));
          transfer::glsl::shadeMatrices({.lights = lights.coefficients(),
                                         .page = page,
                                         .places = tables.places,
                                         .gaunt = gaunt,
                                         .products = products,
                                         .samples = wanted},
                                        record);
        }
      }
      for (uint e = fill.first_output; e < fill.first_output + fill.output_count; ++e)
        for (int c = 0; c < 4; ++c) {
          largest = lambent::testing::larger(largest, std::abs(wanted[e][c]));
          difference = lambent::testing::larger(difference, std::abs(wanted[e][c] - got[e][c]));
        }
    }
    return difference / largest;
  }
};

}  // namespace lambent::evaluate::testing
