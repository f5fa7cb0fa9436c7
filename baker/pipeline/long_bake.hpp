// Says before a bake begins that it will take long, so that nobody waits for minutes unwarned. What it says
// is a guess, from the plan and the numbers of vertices alone, which costs nothing and may be wrong by a
// factor of two, of open shapes by four; `lambent plan` rehearses the bake and knows better.
#pragma once

#include <optional>
#include <string>

#include "baker/bake/options.hpp"
#include "baker/import/scene.hpp"
#include "baker/plan/effect_plan.hpp"

namespace lambent::baker {

// Returns about how many seconds of processor time, of about 2020's x86, a bake of surfaces takes.
double guessProcessorSeconds(const Scene& scene, const EffectPlan& plan, const BakeOptions& options);

// Bakes of which this or more is guessed are announced. They may take over a minute, since guesses err.
inline constexpr double kLongBake_s = 40.0;

// Returns a sentence for a bake that takes so much processor time, or nothing if that is not long.
std::optional<std::string> longBakeNotice(double processor_seconds);

}  // namespace lambent::baker
