// From transfer matrices at samples to the vectors that the payloads of a glossy cell hold: visibility,
// bounced light, light of the group's own lights, each coded by itself (runtime/transfer/codebook.hpp).
#pragma once

#include <vector>

#include "baker/effects/diffuse/payloads.hpp"
#include "baker/effects/glossy/glossy_transport.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

// Visibility first; bounced light where some reaches the cell; the lights last. grey_emission: direct light
// of the lights has no colour.
std::vector<CellVectors> glossyCellVectors(const SampleCell& cell, const GlossyField& field,
                                           bool grey_emission);

}  // namespace lambent::baker
