// Says how much light real scenes have per coefficient of each band, relative to band 0. Error bounds are
// stated in shaded radiance over such lights and not in raw coefficients, since an error in a band that
// carries little light matters little.
#pragma once

#include <array>

namespace lambent::baker {

// This is the mean over lights of (sum over m and RGB of l_lm²) / (2l+1), each light divided by its own band
// 0. If lights are rotated at random, the covariance of their vectors is diagonal with these entries, so they
// are all that the mean error needs. The lights are those of docs/design/reference.md.
inline constexpr std::array<double, 8> kBandPower = {1.0,    0.5085, 0.3297, 0.2374,
                                                     0.1984, 0.1678, 0.1428, 0.1173};

// BandPower is the power of a glossy kernel per coefficient of each band, relative to band 0. It weights
// errors of transferred light. kLobePower is that of GGX of roughness 0.3, the sharpest of which order 5
// carries a fair part (mean over views 11 to 77 degrees from the normal); a bake uses the power of its own
// materials.
using BandPower = std::array<double, 6>;
inline constexpr BandPower kLobePower = {1.0, 0.910, 0.795, 0.682, 0.579, 0.486};

}  // namespace lambent::baker
