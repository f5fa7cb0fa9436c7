// The tables of GLSL text that programs of this room include files from.
#pragma once

#include "lambent_evaluate_embedded.hpp"
#include "lambent_transfer_embedded.hpp"
#include "runtime/gpu/program.hpp"

namespace lambent::evaluate {

inline constexpr gpu::FindText kEvaluateShaders[] = {&embedded::lambent_evaluate::find,
                                                     &embedded::lambent_transfer::find};

}  // namespace lambent::evaluate
