// Declares the functions that make the passes of the frame (frame_pass.hpp), for the list of passes. A file
// has one pass, or two that are halves of the same effect. They fail if a shader does not compile.
#pragma once

#include <memory>

#include "runtime/base/result.hpp"
#include "runtime/frame/frame_pass.hpp"

namespace lambent::frame {

// Holds what passes are made from.
struct PassSetup {
  const FrameOptions& options;
  const lighting::Environment& environment;
  Blackboard& board;
};

using MadePass = Result<std::unique_ptr<FramePass>>;

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

}  // namespace lambent::frame
