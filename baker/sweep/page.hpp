// Writes what a sweep measured as one page that needs no other file: plots of error against cost, the setting
// that is recommended and why, pictures beside the reference, a chart for each knob, where errors and times
// come from, and all figures. Names are escaped, and the page loads nothing. Pure, but for pictures that are
// read from where the sweep has them; one that is gone is left out.
#pragma once

#include <string>

#include "baker/sweep/sweep.hpp"

namespace lambent::baker {

Result<std::string> pageOf(const SweepResults& results);

}  // namespace lambent::baker
