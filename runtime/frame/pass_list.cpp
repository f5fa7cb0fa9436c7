#include "runtime/frame/pass_list.hpp"

#include <span>
#include <utility>

namespace lambent::frame {

namespace {

using MakePass = MadePass (*)(const PassSetup&);

constexpr MakePass kStepPasses[] = {
    &makeUploadPass,        // uploads what has arrived, within the budget
    &makeTransformsPass,    // places nodes and rigid groups
    &makeLightPass,         // light at each light probe, windowed, in its group's frame
    &makePatchBouncesPass,  // bounces of lights among the surfaces, and of key lights
    &makeDiffusePass,       // E/pi at every vertex whose light or transfer changed
    &makeSeenSkyPass,       // what vertices of smooth dielectrics see of the sky, once transfer has arrived
    &makeGlossyPass,        // transferred light at samples of glossy surfaces, likewise
    &makeNeighborhoodPass,  // changes of light around bodies with grids
    &makeCapturePass,       // light between bodies, which arrives with the next step
};

constexpr MakePass kPicturePasses[] = {
    &makeSkyPass,                     // the sky behind all surfaces
    &makeLocalShadowsPass,            // shadow cubes of lights among the surfaces
    &makeKeyShadowsPass,              // shadow maps of key lights over the visible area
    &makePrefilteredEnvironmentPass,  // the sky as rough mirrors show it
    &makeReflectionProbesPass,        // rooms as mirrors in them show them
    &makeRasterPass,                  // surfaces, sky, blended surfaces: linear radiance
    &makeVolumePass,                  // light in volumes that are in view, as rays look it up
    &makeMarchPass,                   // what volumes scatter and absorb
    &makeToneMapPass,                 // exposure, tone curve, sRGB
    &makeOverlayPass,                 // overlays and wires, not tone-mapped
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
