// Measures how much of a highlight few bands can represent.
#pragma once

namespace lambent::baker {

// Returns the share of the energy (integral of the square over directions) of the GGX lobe times cosine, seen
// along the normal, that lies in the first `order` bands: near 1 for rough surfaces, towards 0 for mirrors.
// Roughness is glTF's, 0..1.
double lobeEnergyShare(double roughness, int order);

}  // namespace lambent::baker
