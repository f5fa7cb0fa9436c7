// Loads the distant lights of a request, each separately, and combines them with their factors. With factors
// of 1 the result is bit-identical to that of loadDistantLights().
#pragma once

#include <vector>

#include "runtime/spec/distant_lights.hpp"

namespace lambent::baker::reference {

// Returns one entry per light; entries of lights within the scene are empty. Errors: an environment map
// cannot be loaded.
Result<std::vector<spec::DistantLights>> loadEach(const std::vector<spec::Light>& lights);

// Combines the lights. `factors` has one factor per light; missing ones are 1.
spec::DistantLights together(const std::vector<spec::DistantLights>& each, const std::vector<float>& factors);

// Adds the lights in `more`, which may be null.
void addLights(spec::DistantLights& lights, const spec::DistantLights* more);

}  // namespace lambent::baker::reference
