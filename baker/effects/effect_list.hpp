// Lists the effects that the baker knows. A new effect adds its room beside diffuse/ and its line here; on
// the runtime's side it adds its room and its calls in runtime/frame/frame.cpp.
#pragma once

#include <span>

#include "baker/plan/effect_plan.hpp"

namespace lambent::baker {

std::span<const EffectEntry> effectList();

}  // namespace lambent::baker
