// Runs the diffuse effect and its proxies on random cells, and compares what they write with their CPU twin.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "runtime/effects/diffuse/diffuse.hpp"
#include "runtime/effects/diffuse/diffuse_ref.hpp"
#include "runtime/effects/diffuse/proxies.hpp"
#include "tests/runtime/effects/diffuse/shading_bench.hpp"
#include "tests/support/differences.hpp"

namespace lambent::effects::diffuse {

struct DiffuseBench : testing::ShadingBench<Diffuse> {
  using ShadingBench::ShadingBench;
  Diffuse& diffuse = effect;
  Proxies proxies;

  std::uint32_t shade(evaluate::TransferMode mode = evaluate::TransferMode::Full) { return shadeIn(mode); }

  std::vector<std::uint64_t> shadedGroups() const {
    std::vector<std::uint64_t> shaded;
    for (std::size_t g = 0; g < residency.groups().size(); ++g) shaded.push_back(diffuse.versionOf(g));
    return shaded;
  }

  using Pages = std::vector<std::vector<uint>>;
  static Pages pagesOf(gpu::Arena& arena) {
    Pages pages(std::max(arena.pageCount(), 1u));
    for (std::uint32_t i = 0; i < arena.pageCount(); ++i) {
      pages[i].resize(arena.page(i).byteCount() / 4);
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

  // Returns the largest difference from the twin over vertices and samples, relative to the largest value.
  double differenceToTwin() {
    const Pages transfer = pagesOf(residency.transfer()), rows = pagesOf(residency.rows()),
                geometry = pagesOf(residency.geometry()), radiance = pagesOf(residency.radiance());
    const Tables& tables = diffuse.tables();
    std::vector<std::vector<glm::vec4>> samples;
    for (std::uint32_t i = 0; i < residency.samples().pageCount(); ++i)
      samples.emplace_back(residency.samples().page(i).byteCount() / 16, glm::vec4(0.0f));
    std::vector<glm::vec4> products(tables.product_count);
    for (std::size_t i = 0; i < tables.cells.size(); ++i) {
      const streaming::ResidentCell& resident = residency.cells()[i];
      if (!resident.usable()) continue;
      transfer::ref::Memory memory;
      memory.lights = lights.coefficients();
      memory.transfer = transfer[resident.block.page];
      for (uint t = 0; t < tables.cells[i].count; ++t) {
        const transfer::TransferRecord& record = tables.transfers[tables.cells[i].first + t];
        transfer::ref::projectVectors(memory, record, tables.places, products);
        for (uint position = 0; position < record.sample_count; ++position)
          transfer::ref::shadeVector(memory, record, tables.places, products, position,
                                     samples[residency.groups()[resident.group].samples.page]);
      }
    }
    double difference = 0.0, largest = 0.0;
    const Pages shaded = pagesOf(residency.samples());
    for (std::size_t page = 0; page < samples.size(); ++page)
      for (std::size_t i = 0; i < samples[page].size(); ++i)
        for (int k = 0; k < 4 && samples[page][i] != glm::vec4(0.0f); ++k) {
          const double wanted = double{samples[page][i][k]};
          const double got = double{std::bit_cast<float>(shaded[page][4 * i + static_cast<std::size_t>(k)])};
          largest = testing::larger(largest, std::abs(wanted));
          difference = testing::larger(difference, std::abs(got - wanted));
        }
    for (std::size_t i = 0; i < tables.draws.size(); ++i) {
      const streaming::ResidentDraw& resident = residency.draws()[i];
      const DrawRecord& draw = tables.draws[i];
      const transfer::ref::Memory memory{.lights = lights.coefficients(),
                                         .transfer = {},
                                         .samples = samples[residency.groups()[resident.group].samples.page],
                                         .rows = rows[resident.rows.page],
                                         .geometry = geometry[residency.meshes()[resident.mesh].block.page]};
      const std::vector<uint>& result = radiance[resident.radiance.page];
      for (uint v = 0; v < draw.vertex_count; ++v) {
        std::vector<float> expected;
        if (draw.outputs == 1) {
          const glm::vec4 light = ref::shadeVertex(memory, draw, v);
          expected = {light.x, light.y, light.z, light.w};
        } else {
          for (const glm::vec3& light : ref::vertexLight(memory, draw, v))
            expected.insert(expected.end(), {light.x, light.y, light.z});
        }
        for (std::size_t k = 0; k < expected.size(); ++k) {
          // The light that comes straight is a large number where nothing is known of shadows.
          const float wanted = std::min(expected[k], 100.0f);
          const float got =
              std::min(std::bit_cast<float>(result[draw.radiance_word + expected.size() * v + k]), 100.0f);
          if (wanted < 100.0f) largest = testing::larger(largest, std::abs(wanted));
          difference = testing::larger(difference, std::abs(got - wanted));
        }
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
