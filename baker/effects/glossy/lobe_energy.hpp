// How much of a highlight few bands can carry.
#pragma once

namespace lambent::baker {

// Share of the energy (integral of the square over directions) of the GGX lobe times cosine, seen along the
// normal, that lies in `order` bands: near 1 for what is rough, towards 0 for mirrors. Roughness as glTF has
// it, 0..1.
double lobeEnergyShare(double roughness, int order);

}  // namespace lambent::baker
