// Lists the passes of the frame in their order; it is the only place that names them all. Passes of a step
// bring light to where it is needed; passes of a picture draw it.
#pragma once

#include <memory>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/draws/surface_module.hpp"
#include "runtime/frame/frame_pass.hpp"

namespace lambent::frame {

struct PassList {
  std::unique_ptr<SurfaceModules> surface_modules;  // modules that passes add, in the order of the passes
  std::vector<std::unique_ptr<FramePass>> step, picture;
};

// Makes all passes, which offer what they keep on the board. Fails if a shader does not compile.
Result<PassList> makePassList(const FrameOptions& options, const lighting::Environment& environment,
                              Blackboard& board);

}  // namespace lambent::frame
