// The tables of GLSL text that programs of this room include files from.
#pragma once

#include "lambent_effects_diffuse_embedded.hpp"
#include "lambent_transfer_embedded.hpp"
#include "runtime/gpu/program.hpp"

namespace lambent::effects::diffuse {

inline constexpr gpu::FindText kDiffuseShaders[] = {&embedded::lambent_effects_diffuse::find,
                                                    &embedded::lambent_transfer::find};

}  // namespace lambent::effects::diffuse
