// Loads the light from infinity of a request: each light once, and all of them together, each multiplied by
// its factor. With factors of 1 the result equals that of loadDistantLights() to the bit.
#pragma once

#include <vector>

#include "runtime/spec/distant_lights.hpp"

namespace lambent::baker::reference {

// Returns one entry per light; those of lights in the scene are empty. Errors: those of loading an
// environment map.
Result<std::vector<spec::DistantLights>> loadEach(const std::vector<spec::Light>& lights);

// `factors` holds one per light; 1 is used beyond the list.
spec::DistantLights together(const std::vector<spec::DistantLights>& each, const std::vector<float>& factors);

// Adds the lights in `more`, which may be null.
void addLights(spec::DistantLights& lights, const spec::DistantLights* more);

}  // namespace lambent::baker::reference
