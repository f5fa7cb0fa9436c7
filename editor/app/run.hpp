// Runs the editor's loop: input, what has changed outside (files, bakes), the world's step, the picture,
// panels. It rests while nothing moves. Errors: no window, a script that cannot be read or that failed.
#pragma once

#include "editor/app/options.hpp"
#include "runtime/base/result.hpp"

namespace lambent::editor {

Result<void> run(const Options& options);

}  // namespace lambent::editor
