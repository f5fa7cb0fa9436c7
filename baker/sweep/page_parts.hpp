// The parts of the page (page.hpp), each a piece of HTML. Pure.
#pragma once

#include <map>
#include <string>

#include "baker/sweep/advice.hpp"
#include "baker/sweep/plot.hpp"
#include "baker/sweep/sweep.hpp"

namespace lambent::baker {

// Returns the plot of error against a cost.
Plot plotOf(const SweepResults& results, const Cost& cost, const Advice& advice);

// Says what is recommended, for a bake and for a frame.
std::string answersPart(const SweepResults& results);
// Shows the plots, one for each cost, behind tabs.
std::string plotsPart(const SweepResults& results);
// Shows a chart for each knob.
std::string knobsPart(const SweepResults& results);
// Divides errors into their causes, and times into stages and passes.
std::string causesPart(const SweepResults& results);
// Says how and on what it was measured, with a table of all figures.
std::string methodPart(const SweepResults& results);

}  // namespace lambent::baker
