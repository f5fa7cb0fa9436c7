// Arranges the transfer matrices at samples into the vectors that the payloads of a glossy cell hold:
// visibility, bounced light, and light of the group's own lights, each coded by itself
// (runtime/transfer/codebook.hpp).
#pragma once

#include <vector>

#include "baker/effects/diffuse/payloads.hpp"
#include "baker/effects/glossy/glossy_transport.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

// Returns visibility first, then bounced light if some reaches the cell, then the lights. `grey_emission`
// says that direct light of the lights has no colour.
std::vector<CellVectors> glossyCellVectors(const SampleCell& cell, const GlossyField& field,
                                           bool grey_emission);

}  // namespace lambent::baker
