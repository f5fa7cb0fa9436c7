// The one list of effects on the baker's side. A new effect adds its room beside diffuse/ and its line here;
// the runtime has the same list in runtime/frame.
#pragma once

#include <span>

#include "baker/plan/effect_plan.hpp"

namespace lambent::baker {

std::span<const EffectEntry> effectList();

}  // namespace lambent::baker
