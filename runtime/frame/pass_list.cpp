#include "runtime/frame/pass_list.hpp"

#include <span>
#include <utility>

#include "runtime/frame/passes/passes.hpp"

namespace lambent::frame {

namespace {

using MakePass = MadePass (*)(const PassSetup&);

constexpr MakePass kStepPasses[] = {
    &makeUploadPass,        // what has arrived goes to the GPU, within the budget
    &makeTransformsPass,    // where nodes and rigid groups stand
    &makeLightPass,         // what arrives at each light probe, windowed, in its group's frame
    &makePatchBouncesPass,  // what surfaces send on of lights that stand among them, and of key lights
    &makeDiffusePass,       // E/pi at every vertex whose light or transfer is new
    &makeGlossyPass,        // transferred light at the samples of glossy surfaces, likewise
    &makeVolumePass,        // what of it rays through volumes look up
    &makeNeighborhoodPass,  // what bodies with grids change around them
    &makeCapturePass,       // what bodies send to each other: arrives with the next step
};

constexpr MakePass kPicturePasses[] = {
    &makeSkyPass,                     // what is seen where nothing stands
    &makeLocalShadowsPass,            // cubes of the lights that stand among surfaces
    &makeKeyShadowsPass,              // shadow maps of key lights over what is seen
    &makePrefilteredEnvironmentPass,  // the sky as rough mirrors show it
    &makeRasterPass,                  // surfaces, sky, blended surfaces: linear radiance
    &makeMarchPass,                   // what volumes scatter and let through
    &makeToneMapPass,                 // exposure, tone curve, sRGB
    &makeOverlayPass,                 // what is asked for to be seen besides, as it is
};

Result<std::vector<std::unique_ptr<FramePass>>> make(std::span<const MakePass> list, const PassSetup& setup) {
  std::vector<std::unique_ptr<FramePass>> passes;
  for (const MakePass one : list) {
    MadePass made = one(setup);
    if (!made) return failAgain(made.error());
    passes.push_back(std::move(*made));
  }
  return passes;
}

}  // namespace

Result<PassList> makePassList(const FrameOptions& options, const lighting::Environment& environment,
                              Blackboard& board) {
  auto modules = std::make_unique<SurfaceModules>();
  board.offer(*modules);
  const PassSetup setup{.options = options, .environment = environment, .board = board};
  auto step = make(kStepPasses, setup);
  if (!step) return failAgain(step.error());
  auto picture = make(kPicturePasses, setup);
  if (!picture) return failAgain(picture.error());
  return PassList{
      .surface_modules = std::move(modules), .step = std::move(*step), .picture = std::move(*picture)};
}

}  // namespace lambent::frame
