// The passes of the frame in their order: the one place that names them all. Those of a step bring light to
// where it is needed; those of a picture draw it.
#pragma once

#include <memory>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/draws/surface_module.hpp"
#include "runtime/frame/frame_pass.hpp"

namespace lambent::frame {

struct PassList {
  std::unique_ptr<SurfaceModules> surface_modules;  // that passes add, in the order of the passes
  std::vector<std::unique_ptr<FramePass>> step, picture;
};

// Passes offer what they keep on the board. Errors: shaders that do not compile.
Result<PassList> makePassList(const FrameOptions& options, const lighting::Environment& environment,
                              Blackboard& board);

}  // namespace lambent::frame
