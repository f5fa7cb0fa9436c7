// Says before a bake begins that it will take long, so that nobody waits for minutes unwarned.
#pragma once

#include <optional>
#include <string>

namespace lambent::baker {

// Bakes of which this or more is guessed are announced. They may take over a minute, since guesses err.
inline constexpr double kLongBake_s = 40.0;

// Returns a sentence for a bake that takes so much processor time (guess_seconds.hpp), or nothing if that is
// not long.
std::optional<std::string> longBakeNotice(double processor_seconds);

}  // namespace lambent::baker
