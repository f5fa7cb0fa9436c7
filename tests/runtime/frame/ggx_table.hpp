// A table of GGX lobes in five bands, coarse enough to be made in a test.
#pragma once

#include "baker/brdf/brdf.hpp"

namespace lambent::testing {

inline const bundle::BrdfTable& ggxTable() {
  static const bundle::BrdfTable table =
      baker::integrateTable(*baker::makeGgx(/*anisotropic=*/false), 5,
                            {.angles = 12, .azimuths = 1, .roughnesses = 6, .strengths = 1});
  return table;
}

}  // namespace lambent::testing
