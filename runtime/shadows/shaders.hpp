// The tables of GLSL text that programs of this room include files from.
#pragma once

#include "lambent_draws_embedded.hpp"
#include "lambent_shadows_embedded.hpp"
#include "runtime/gpu/program.hpp"

namespace lambent::frame {

inline constexpr gpu::FindText kShadowShaders[] = {&embedded::lambent_shadows::find,
                                                   &embedded::lambent_draws::find};

}  // namespace lambent::frame
