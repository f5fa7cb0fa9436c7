// The tables of GLSL text that programs of this room include files from.
#pragma once

#include "lambent_lighting_embedded.hpp"
#include "runtime/gpu/program.hpp"

namespace lambent::lighting {

inline constexpr gpu::FindText kLightingShaders[] = {&embedded::lambent_lighting::find};

}  // namespace lambent::lighting
