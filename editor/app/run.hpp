// Runs the editor's loop: it takes input and outside changes (files, bakes), steps the world, and draws the
// picture and the panels. It sleeps while nothing moves. Errors: no window can be opened; the script cannot
// be read, or one of its lines failed.
#pragma once

#include "editor/app/options.hpp"
#include "runtime/base/result.hpp"

namespace lambent::editor {

Result<void> run(const Options& options);

}  // namespace lambent::editor
