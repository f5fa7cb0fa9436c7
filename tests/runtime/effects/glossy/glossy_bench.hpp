// Random glossy cells on the GPU, and what the CPU twin makes of the same memory.
#pragma once

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/effects/glossy/glossy.hpp"
#include "runtime/effects/glossy/glossy_ref.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/runtime/effects/diffuse/diffuse_fixture.hpp"

namespace lambent::effects::glossy::testing {

struct Bench {
  streaming::Residency residency;
  Glossy glossy;
  lighting::GroupLights lights;
  lambent::testing::RandomBundle made;
  std::vector<lighting::GroupPlace> places;
  std::vector<sh::LightVector> incident;
  lighting::Environment environment = *lighting::Environment::create(
      {spec::SunLight{
           .azimuth_deg = 30, .elevation_deg = 40, .angle_deg = 25, .radiance = {3.0f, 2.0f, 1.0f}},
       spec::ConstantLight{.radiance = {0.2f, 0.3f, 0.5f}}});

  Bench(lambent::testing::BundleMaker& maker, const lambent::testing::RandomBundleOptions& options)
      : made(maker.make(options)) {
    EXPECT_TRUE(residency.add(made.description));
    for (std::uint32_t k = 0; k < options.light_samples; ++k)
      incident.push_back(sh::discLight(static_cast<int>(options.order), maker.direction(), 0.7,
                                       glm::vec3(1.0f, 2.0f, 0.5f)));
    for (std::uint32_t g = 0; g < options.groups; ++g) {
      places.push_back({.world_from_group = maker.rotation(),
                        .order = options.order,
                        .lamps = std::vector<glm::vec3>(options.lamps, glm::vec3(0.7f, 0.3f, 1.1f))});
      if (options.light_samples > 1) places.back().incident.clear();
      for (std::uint32_t k = 0; k < options.light_samples && options.light_samples > 1; ++k)
        places.back().incident.push_back({.light = &incident[k], .version = 1});
    }
  }

  void upload(const streaming::Ready& item) { ASSERT_TRUE(residency.upload(0, item)); }
  void uploadAll() {
    for (const auto& item : made.meshes) upload(item);
    for (const auto& item : made.rows) upload(item);
    for (std::size_t cell = 0; cell < made.codebooks.size(); ++cell) uploadCell(cell);
  }
  void uploadCell(std::size_t cell) {
    if (!made.light_weights.empty()) upload(made.light_weights[cell]);
    for (const auto& item : made.codebooks[cell]) upload(item);
    for (const auto& plane : made.planes[cell]) upload(plane);
  }
  std::uint32_t shade(TransferMode mode = TransferMode::Full) {
    gpu::Counters counters;
    lights.update(environment, sh::Window::Off, places, counters);
    const Result<void> shaded = glossy.shade(residency, lights, mode, counters);
    EXPECT_TRUE(shaded) << shaded.error().line();
    return counters.dispatches;
  }

  static std::vector<glm::vec4> samplesOf(gpu::Arena& arena, std::uint32_t page) {
    std::vector<glm::vec4> samples(arena.page(page).byteCount() / sizeof(glm::vec4));
    arena.page(page).read(0, std::span(samples));
    return samples;
  }

  // Largest difference of a glossy sample to the twin's, relative to the largest value; RGB and visibility.
  double differenceToTwin() {
    double difference = 0.0, largest = 0.0;
    const TransferTable& tables = glossy.tables();
    std::vector<glm::vec4> products(tables.product_count);
    for (std::size_t i = 0; i < tables.cells.size(); ++i) {
      const streaming::ResidentCell& cell = residency.cells()[i];
      if (!cell.glossy()) continue;
      const std::vector<glm::vec4> got =
          samplesOf(residency.samples(), residency.groups()[cell.group].samples.page);
      std::vector<glm::vec4> wanted(got.size(), glm::vec4(0.0f));
      diffuse::ref::Memory memory;
      memory.lights = lights.coefficients();
      const FillRecord& fill = glossy.fills()[i];
      if (tables.cells[i].count == 0 || !cell.usable()) {
        for (uint e = 0; e < fill.output_count; ++e)
          wanted[fill.first_output + e] = ref::openLight(memory, fill, e % fill.outputs);
      } else {
        std::vector<uint> page(residency.transfer().page(cell.block.page).byteCount() / 4);
        residency.transfer().page(cell.block.page).read(0, std::span(page));
        memory.transfer = page;
        for (uint t = 0; t < tables.cells[i].count; ++t) {
          const diffuse::TransferRecord& record = tables.transfers[tables.cells[i].first + t];
          if (record.visibility != 0)
            ref::projectTransfer(memory, gauntWords(record.order, bandsOf(record.outputs)), record,
                                 tables.places, products);
          else
            diffuse::ref::projectTransfer(memory, record, tables.places, products);
          for (uint position = 0; position < record.sample_count; ++position)
            ref::shadePosition(memory, record, tables.places, products, position, wanted);
        }
      }
      for (uint e = fill.first_output; e < fill.first_output + fill.output_count; ++e)
        for (int c = 0; c < 4; ++c) {
          largest = std::max<double>(largest, std::abs(wanted[e][c]));
          difference = std::max<double>(difference, std::abs(wanted[e][c] - got[e][c]));
        }
    }
    return difference / largest;
  }

  static std::uint32_t bandsOf(std::uint32_t outputs) { return outputs == 16 ? 4 : outputs == 25 ? 5 : 6; }
};

}  // namespace lambent::effects::glossy::testing
