// Converts the strength of a local light to the units in which lamps are sold and measured. Components store
// candela for point and spot lights, lux for directional ones and cd/m² for spheres and discs (1 cd = 1 W/sr
// up to the global scale of all light). All functions are pure.
#pragma once

#include <string_view>
#include <vector>

#include "runtime/scene/components.hpp"

namespace lambent::editor {

struct LightUnit {
  std::string_view name;  // "lm"
  std::string_view help;  // what it measures
  double factor = 1.0;    // value in this unit for each unit of the component's strength; > 0
};

// Returns the units in which this light can be given, that of the component first. Colour counts as white.
std::vector<LightUnit> unitsOf(const scene::LocalLightComponent& light);
// Returns the unit of this name, or the first if the light has none of that name.
LightUnit unitOf(const scene::LocalLightComponent& light, std::string_view name);

}  // namespace lambent::editor
