// The tables of GLSL text that programs of this room include files from.
#pragma once

#include "lambent_debug_embedded.hpp"
#include "lambent_draws_embedded.hpp"
#include "lambent_effects_neighborhood_embedded.hpp"
#include "lambent_evaluate_embedded.hpp"
#include "lambent_lighting_embedded.hpp"
#include "lambent_shadows_embedded.hpp"
#include "lambent_surface_embedded.hpp"
#include "lambent_tone_map_embedded.hpp"
#include "lambent_transfer_embedded.hpp"
#include "runtime/gpu/program.hpp"

namespace lambent::frame {

inline constexpr gpu::FindText kDebugShaders[] = {&embedded::lambent_debug::find,
                                                  &embedded::lambent_draws::find,
                                                  &embedded::lambent_surface::find,
                                                  &embedded::lambent_shadows::find,
                                                  &embedded::lambent_tone_map::find,
                                                  &embedded::lambent_lighting::find,
                                                  &embedded::lambent_evaluate::find,
                                                  &embedded::lambent_transfer::find,
                                                  &embedded::lambent_effects_neighborhood::find};

}  // namespace lambent::frame
