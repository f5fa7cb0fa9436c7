// Lists the passes of the frame in their order; it is the only place that names them all. Passes of a step
// bring light to where it is needed; passes of a picture draw it.
#pragma once

#include <memory>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/draws/surface_module.hpp"
#include "runtime/frame/frame_pass.hpp"

namespace lambent::frame {

// Holds what passes are made from.
struct PassSetup {
  const FrameOptions& options;
  const lighting::Environment& environment;
  Blackboard& board;
};

using MadePass = Result<std::unique_ptr<FramePass>>;

// Each makes a pass; a file under passes/ has those of one kind of work. They fail if a shader does not
// compile.
MadePass makeUploadPass(const PassSetup& setup);
MadePass makeTransformsPass(const PassSetup& setup);
MadePass makeLightPass(const PassSetup& setup);
MadePass makePatchBouncesPass(const PassSetup& setup);
MadePass makeDiffusePass(const PassSetup& setup);
MadePass makeSeenSkyPass(const PassSetup& setup);
MadePass makeGlossyPass(const PassSetup& setup);
MadePass makeVolumePass(const PassSetup& setup);
MadePass makeNeighborhoodPass(const PassSetup& setup);
MadePass makeCapturePass(const PassSetup& setup);

MadePass makeSkyPass(const PassSetup& setup);
MadePass makeLocalShadowsPass(const PassSetup& setup);
MadePass makeKeyShadowsPass(const PassSetup& setup);
MadePass makePrefilteredEnvironmentPass(const PassSetup& setup);
MadePass makeReflectionProbesPass(const PassSetup& setup);
MadePass makeRasterPass(const PassSetup& setup);
MadePass makeMarchPass(const PassSetup& setup);
MadePass makeToneMapPass(const PassSetup& setup);
MadePass makeOverlayPass(const PassSetup& setup);

struct PassList {
  std::unique_ptr<SurfaceModules> surface_modules;  // modules that passes add, in the order of the passes
  std::vector<std::unique_ptr<FramePass>> step, picture;
};

// Makes all passes, which offer what they keep on the board. Fails if a shader does not compile.
Result<PassList> makePassList(const FrameOptions& options, const lighting::Environment& environment,
                              Blackboard& board);

}  // namespace lambent::frame
