// The tables of GLSL text that programs of this room include files from.
#pragma once

#include "lambent_effects_neighborhood_embedded.hpp"
#include "lambent_transfer_embedded.hpp"
#include "runtime/gpu/program.hpp"

namespace lambent::effects::neighborhood {

inline constexpr gpu::FindText kNeighborhoodShaders[] = {&embedded::lambent_effects_neighborhood::find,
                                                         &embedded::lambent_transfer::find};

}  // namespace lambent::effects::neighborhood
