// The shaders that write grids of neighborhoods and look them up, as C++.
#pragma once

#include "runtime/effects/neighborhood/neighborhood_shared.h"
#include "tests/support/glsl/glsl.hpp"

namespace lambent::effects::neighborhood::glsl {

using namespace lambent::glsl;

struct Write : Invocation {
#include "as_cpp/neighborhood_write.comp"
};

struct Lookup {
  Texels atlas;
  vec4 atlasAt(vec3 texel) { return atlas.sample(texel / vec3(atlas.size)); }
#include "as_cpp/neighborhood_eval.glsl"
};

// Writes the samples of a cell into the atlas.
inline void write(Texels& atlas, const WriteRecord& cell, std::span<const vec4> samples) {
  Write kernel;
  kernel.writes = std::span(&cell, 1);
  kernel.samples = samples;
  kernel.atlas = std::move(atlas);
  run(kernel, cell.point_count * cell.grid.outputs);
  atlas = std::move(kernel.atlas);
}

}  // namespace lambent::effects::neighborhood::glsl
