// One frame, from what has arrived to the picture: a walk along the list of passes (pass_list.hpp). Every
// pass runs only if something that it reads is newer than its last output; each is timed, counts what it
// issued and says why. World, environment (also another object) and settings may be changed between frames as
// one likes. The picture goes to the frame's own target, which can be read back, or to the window's
// framebuffer. Errors: shaders that do not compile, a bundle that turns out damaged while it loads.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "runtime/base/result.hpp"
#include "runtime/debug/picker.hpp"
#include "runtime/frame/blackboard.hpp"
#include "runtime/frame/frame_options.hpp"
#include "runtime/frame/invalidation_log.hpp"
#include "runtime/frame/pass_list.hpp"
#include "runtime/frame/picture_targets.hpp"
#include "runtime/frame/step_counts.hpp"
#include "runtime/gpu/pass_timers.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/spec/size.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// After so many steps a still scene is taken to be at rest: light has gone to and fro as often.
inline constexpr std::uint32_t kMaxRestSteps = 16;

class Frame {
 public:
  static Result<Frame> create(const FrameOptions& options, const lighting::Environment& environment);

  const FrameSettings& settings() const { return options_.settings; }
  // From the next step on; only what depends on what is other than before runs again. Errors: a value out of
  // its range (nothing is changed).
  Result<void> setSettings(const FrameSettings& settings);
  // The next step computes everything anew, as if all had just arrived.
  void forget();

  // A step and a picture.
  Result<void> render(World& world, const lighting::Environment& environment, const spec::View& view);
  // Steps until no light changes any more, at most kMaxRestSteps; returns how many it took. No picture.
  Result<std::uint32_t> rest(World& world, const lighting::Environment& environment);
  void resize(const spec::Size& size);
  // What is seen at a point of the picture, in pixels from its top left corner (that of pixel i, j has its
  // middle at i + 0.5, j + 0.5); none: the sky. Of what the last picture showed. Waits for the GPU.
  Result<std::optional<Picked>> pick(World& world, const spec::View& view, float x, float y);

  // From the next picture on.
  void setView(const ViewChoice& choice) { options_.view = choice; }
  void setOverlays(OverlayOptions overlays) { options_.overlays = std::move(overlays); }
  // By which the last picture is to be read.
  ViewLegend legend() const;

  // Waits for the GPU. Row 0 is the top. Linear pictures have depths, of what wrote to the depth buffer: in
  // views of transfer blended surfaces too, with overlays the signs of light probes.
  spec::RgbaImage readLinear() const { return targets_.readLinear(clip_from_view_); }
  spec::Rgba8Image readDisplay() const { return targets_.readDisplay(); }
  // What the last render() left, where it does not go to the window; row 0 is the bottom.
  const gpu::Texture& picture() const { return targets_.picture(); }
  // Of the last picture; these wait for the GPU.
  std::uint32_t negativePixels() const;
  float exposureEv() const;

  gpu::PassTimers& timers() { return timers_; }
  const StepCounts& counts() const { return counts_; }
  // What passes keep, by type.
  template <class Type>
  const Type& kept() const {
    return board_.get<Type>();
  }
  const FrameOptions& options() const { return options_; }

 private:
  Frame(const FrameOptions& options, PassList passes, Blackboard board);

  FrameContext contextOf(World& world, const lighting::Environment& environment, const spec::View* view);
  Result<void> step(FrameContext& context);
  Result<void> walk(std::span<const std::unique_ptr<FramePass>> passes, FrameContext& context);
  bool atRest(const World& world, const lighting::Environment& environment) const;

  FrameOptions options_;
  Blackboard board_;
  PassList passes_;
  PictureTargets targets_;
  InvalidationLog log_;
  StepCounts counts_;
  gpu::PassTimers timers_;
  Picker picker_;
  std::uint64_t environment_ = 0;   // version that the last step met
  bool settled_ = false;            // whether a step has run since the settings changed
  bool forgotten_ = false;          // whether none has since forget()
  glm::mat4 clip_from_view_{1.0f};  // of the last picture
};

}  // namespace lambent::frame
