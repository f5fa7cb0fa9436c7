// Shades the samples of random cells on the GPU: it uploads the cells' transfer and shades once.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/evaluate/samples.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/runtime/effects/diffuse/diffuse_fixture.hpp"

namespace lambent::testing {

struct ShadingBench {
  streaming::Residency residency;
  evaluate::Samples samples;
  lighting::GroupLights lights;
  RandomBundle made;
  std::vector<lighting::GroupPlace> places;
  std::vector<sh::LightVector> incident;
  lighting::Environment environment = *lighting::Environment::create(
      {spec::SunLight{
           .azimuth_deg = 30, .elevation_deg = 40, .angle_deg = 25, .radiance = {3.0f, 2.0f, 1.0f}},
       spec::ConstantLight{.radiance = {0.2f, 0.3f, 0.5f}}});

  ShadingBench(BundleMaker& maker, const RandomBundleOptions& options,
               std::uint64_t page_bytes = gpu::Arena::kMaxPageBytes)
      : residency(page_bytes), made(maker.make(options)) {
    EXPECT_TRUE(residency.add(made.description, 0));
    for (std::uint32_t k = 0; k < options.light_probes; ++k)
      incident.push_back(sh::discLight(static_cast<int>(options.order), maker.direction(), 0.7,
                                       glm::vec3(1.0f, 2.0f, 0.5f)));
    for (std::uint32_t g = 0; g < options.groups; ++g) {
      places.push_back({.world_from_group = maker.rotation(),
                        .order = options.order,
                        .lamps = std::vector<glm::vec3>(options.lamps, glm::vec3(0.7f, 0.3f, 1.1f))});
      if (options.light_probes > 1) places.back().incident.clear();
      for (std::uint32_t k = 0; k < options.light_probes && options.light_probes > 1; ++k)
        places.back().incident.push_back({.light = &incident[k], .version = 1});
    }
  }

  void upload(const streaming::Ready& item) { ASSERT_TRUE(residency.upload(0, item)); }
  void uploadMeshes() {
    for (const auto& item : made.meshes) upload(item);
  }
  void uploadRows() {
    for (const auto& item : made.rows) upload(item);
  }
  static constexpr std::uint32_t kAllPlanes = std::numeric_limits<std::uint32_t>::max();
  // Uploads the codebooks, and the first `count` planes of each transfer.
  void uploadTransfer(std::uint32_t count = kAllPlanes) {
    for (std::size_t cell = 0; cell < made.codebooks.size(); ++cell) uploadCell(cell, count);
  }
  void uploadCell(std::size_t cell, std::uint32_t count = kAllPlanes) {
    if (!made.light_weights.empty()) upload(made.light_weights[cell]);
    for (const auto& item : made.codebooks[cell]) upload(item);
    for (const auto& plane : made.planes[cell])
      if (plane.plane.value < count) upload(plane);
  }
  void uploadAll(std::uint32_t count = kAllPlanes) {
    uploadMeshes();
    uploadRows();
    uploadTransfer(count);
  }
  void shadeSamples(evaluate::TransferMode mode, const evaluate::ShadedKinds& kinds,
                    gpu::Counters& counters) {
    lights.update(environment, sh::Window::Off, places, counters);
    const Result<void> shaded = samples.shade(residency, lights, mode, counters, kinds);
    EXPECT_TRUE(shaded) << shaded.error().line();
  }
};

}  // namespace lambent::testing
