// Runs lambent-demo in one of two ways. Headless, it loads everything, renders, writes the picture whole or
// not at all, and prints its path (or the report). Windowed, it shows the scene while it loads, under a light
// that turns, until it is closed.
#pragma once

#include "runtime/base/result.hpp"
#include "runtime/demo/options.hpp"

namespace lambent::demo {

Result<void> runHeadless(const Options& options);
Result<void> runWindowed(const Options& options);

}  // namespace lambent::demo
