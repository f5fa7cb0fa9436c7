// The tables of GLSL text that programs of this room include files from.
#pragma once

#include "lambent_effects_volume_embedded.hpp"
#include "runtime/gpu/program.hpp"

namespace lambent::effects::volume {

inline constexpr gpu::FindText kVolumeShaders[] = {&embedded::lambent_effects_volume::find};

}  // namespace lambent::effects::volume
