// Runs the diffuse effect and its proxies on random cells, and compares what they write with what their
// kernels write as C++.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "runtime/effects/diffuse/diffuse.hpp"
#include "tests/runtime/effects/diffuse/diffuse_kernels.hpp"
#include "tests/runtime/evaluate/shading_bench.hpp"
#include "tests/support/differences.hpp"

namespace lambent::effects::diffuse {

struct DiffuseBench : testing::ShadingBench {
  using ShadingBench::ShadingBench;
  Diffuse diffuse;
  Proxies proxies;

  // Shades once and returns the number of dispatches.
  std::uint32_t shade(evaluate::TransferMode mode = evaluate::TransferMode::Full) {
    gpu::Counters counters;
    shadeSamples(mode, {}, counters);
    const Result<void> shaded = diffuse.shade(residency, lights, mode, samples, counters);
    EXPECT_TRUE(shaded) << shaded.error().line();
    return counters.dispatches;
  }

  std::vector<std::uint64_t> shadedGroups() const {
    std::vector<std::uint64_t> shaded;
    for (std::size_t g = 0; g < residency.groups().size(); ++g) shaded.push_back(samples.vectorsVersionOf(g));
    return shaded;
  }

  template <typename Value = uint>
  static std::vector<std::vector<Value>> pagesOf(gpu::Arena& arena) {
    std::vector<std::vector<Value>> pages(std::max(arena.pageCount(), 1u));
    for (std::uint32_t i = 0; i < arena.pageCount(); ++i) {
      pages[i].resize(arena.page(i).byteCount() / sizeof(Value));
      arena.page(i).read(0, std::span(pages[i]));
    }
    return pages;
  }

  // Sets a sun that a few bands cannot represent, and gives light at light probes a key light, too.
  void shineByKeyLights() {
    environment.setMostKeys(16);
    ASSERT_TRUE(environment.setLights(
        {spec::SunLight{
             .azimuth_deg = 30, .elevation_deg = 40, .angle_deg = 2, .radiance = {3000.0f, 2000.0f, 1000.0f}},
         spec::ConstantLight{.radiance = {0.2f, 0.3f, 0.5f}}}));
    ASSERT_FALSE(environment.keys().empty());
    for (lighting::GroupPlace& place : places)
      for (std::size_t k = 0; k < place.incident.size(); ++k)
        if (place.incident[k].light != nullptr) place.incident[k].key = &incident[(k + 1) % incident.size()];
  }

  // Returns the largest difference from the kernels as C++ over vertices and samples, relative to the largest
  // value.
  double differenceToTwin() {
    const auto transfer = pagesOf(residency.transfer()), rows = pagesOf(residency.rows());
    const auto geometry = pagesOf<float>(residency.geometry()),
               radiance = pagesOf<float>(residency.radiance());
    const auto shaded = pagesOf<glm::vec4>(residency.samples());
    const evaluate::TransferTable& tables = samples.tables();
    std::vector<std::vector<glm::vec4>> wanted_samples;
    for (const auto& page : shaded) wanted_samples.emplace_back(page.size(), glm::vec4(0.0f));
    std::vector<glm::vec4> products(tables.product_count);
    for (std::size_t i = 0; i < tables.cells.size(); ++i) {
      const streaming::ResidentCell& resident = residency.cells()[i];
      if (!resident.usable()) continue;
      for (uint t = 0; t < tables.cells[i].count; ++t)
        transfer::glsl::shadeVectors(
            {.lights = lights.coefficients(),
             .page = transfer[resident.block.page],
             .places = tables.places,
             .gaunt = {},
             .products = products,
             .samples = wanted_samples[residency.groups()[resident.group].samples.page]},
            tables.transfers[tables.cells[i].first + t]);
    }
    double difference = 0.0, largest = 0.0;
    const auto compare = [&](float got, float wanted) {
      largest = testing::larger(largest, double{std::abs(wanted)});
      difference = testing::larger(difference, double{std::abs(got - wanted)});
    };
    for (std::size_t page = 0; page < wanted_samples.size(); ++page)
      for (std::size_t i = 0; i < wanted_samples[page].size(); ++i)
        for (int k = 0; k < 4 && wanted_samples[page][i] != glm::vec4(0.0f); ++k)
          compare(shaded[page][i][k], wanted_samples[page][i][k]);
    for (std::size_t i = 0; i < diffuse.draws().size(); ++i) {
      const streaming::ResidentDraw& resident = residency.draws()[i];
      const DrawRecord& draw = diffuse.draws()[i];
      const std::vector<float>& got = radiance[resident.radiance.page];
      std::vector<float> wanted(got.size());
      const auto shadeBy = [&](auto kernel) {
        kernel.lights = lights.coefficients();
        kernel.draws = std::span(&draw, 1);
        kernel.row_words = rows[resident.rows.page];
        kernel.geometry = geometry[residency.meshes()[resident.mesh].block.page];
        kernel.samples = wanted_samples[residency.groups()[resident.group].samples.page];
        kernel.radiance_out = wanted;
        glsl::run(kernel, draw.vertex_count);
      };
      if (draw.outputs == 1)
        shadeBy(glsl::Vertices{});
      else
        shadeBy(glsl::MappedVertices{});
      const uint end = draw.radiance_word + draw.vertex_count * (draw.outputs == 1 ? 4 : 3 * draw.outputs);
      for (uint word = draw.radiance_word; word < end; ++word) {
        // The light that comes straight is a large number where nothing is known of shadows.
        if (wanted[word] < 100.0f) compare(got[word], wanted[word]);
        difference = testing::larger(
            difference, double{std::abs(std::min(got[word], 100.0f) - std::min(wanted[word], 100.0f))});
      }
    }
    return difference / largest;
  }

  // Returns the texels of a level of a draw's texture, row by row.
  std::vector<glm::vec4> textureOf(std::size_t draw, GLint level) const {
    const streaming::ResidentDraw& resident = residency.draws()[draw];
    const std::size_t side = resident.texels >> level;
    std::vector<glm::vec4> texels(side * side);
    glGetTextureImage(resident.irradiance.id(), level, GL_RGBA, GL_FLOAT,
                      static_cast<GLsizei>(texels.size() * sizeof(glm::vec4)), texels.data());
    return texels;
  }
};

}  // namespace lambent::effects::diffuse
