// Makes tables of b(v) that no surface has: they are random, so that every coefficient and axis matters.
#pragma once

#include "runtime/bundle/brdf_table.hpp"
#include "tests/runtime/effects/diffuse/diffuse_fixture.hpp"

namespace lambent::glossy::testing {

inline bundle::BrdfTable randomTable(lambent::testing::BundleMaker& maker, std::uint32_t order,
                                     bool isotropic, std::uint32_t lobes = 2) {
  bundle::BrdfTable table{.order = order,
                          .lobes = lobes,
                          .angles = 9,
                          .azimuths = isotropic ? 1u : 5u,
                          .roughnesses = lobes == 3 ? 1u : 4u,
                          .strengths = isotropic ? 1u : 3u,
                          .values = {}};
  for (std::size_t node = 0; node < table.nodes(); ++node)
    for (std::uint32_t lobe = 0; lobe < lobes; ++lobe)
      for (std::uint32_t c = 0; c < table.coefficients(); ++c)
        table.values.push_back(c == 0 ? maker.uniform(0.05f, 0.13f) : maker.uniform(-0.1f, 0.1f));
  return table;
}

// Makes a table with the same albedo in every direction, split between the lobes, and nothing else.
inline bundle::BrdfTable evenTable(std::uint32_t order, bool isotropic, float f0_albedo, float f90_albedo) {
  bundle::BrdfTable table{.order = order,
                          .lobes = 2,
                          .angles = 4,
                          .azimuths = isotropic ? 1u : 3u,
                          .roughnesses = 3,
                          .strengths = isotropic ? 1u : 2u,
                          .values = {}};
  table.values.assign(table.nodes() * table.nodeValues(), 0.0f);
  for (std::size_t node = 0; node < table.nodes(); ++node) {
    table.values[node * table.nodeValues()] = 0.28209479f * f0_albedo;
    table.values[node * table.nodeValues() + table.coefficients()] = 0.28209479f * f90_albedo;
  }
  return table;
}

}  // namespace lambent::glossy::testing
