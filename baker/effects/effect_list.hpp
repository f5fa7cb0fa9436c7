// Lists the effects that the baker knows, and decides which of them a scene needs. A new effect adds its room
// beside surface/ and its line in effect_list.cpp; on the runtime's side it adds its room and its calls in
// runtime/frame/frame.cpp.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "baker/plan/effect_plan.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

std::span<const EffectEntry> effectList();

// Returns all effects for "auto" and "all", else those of a list such as "diffuse,glossy". The error names
// the effect that is not known.
Result<std::vector<EffectEntry>> effectsNamed(std::string_view words);

}  // namespace lambent::baker
