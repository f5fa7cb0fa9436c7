// The light from infinity of a request: each light loaded once, and all of them together, each times its
// factor. With factors of 1 it is loadDistantLights(), to the bit.
#pragma once

#include <vector>

#include "runtime/spec/distant_lights.hpp"

namespace lambent::baker::reference {

// One for each light; empty for those that stand in the scene. Errors: those of loading a environment map.
Result<std::vector<spec::DistantLights>> loadEach(const std::vector<spec::Light>& lights);

// factors: by light; those beyond the list are 1.
spec::DistantLights together(const std::vector<spec::DistantLights>& each, const std::vector<float>& factors);

// Adds what `more` has, if there is any.
void addLights(spec::DistantLights& lights, const spec::DistantLights* more);

}  // namespace lambent::baker::reference
