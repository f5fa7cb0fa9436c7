// Owns a frame: it runs the list of passes (frame_pass.hpp), from what has arrived to the picture. A pass
// runs only if something that it reads is newer than its last output; each is timed, counts what it issued
// and says why it ran. The world, the environment (also for another object) and the settings may be changed
// between frames. The picture goes to the frame's own target, which can be read back, or to the window's
// framebuffer. Render thread only. Fails if a shader does not compile, or if a bundle turns out damaged while
// it loads.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "runtime/base/result.hpp"
#include "runtime/debug/data_view.hpp"
#include "runtime/frame/frame_pass.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/gpu/pass_timers.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// A still scene counts as at rest after this many steps, in which light has travelled as often between
// bodies.
inline constexpr std::uint32_t kMaxRestSteps = 16;

class Frame {
 public:
  static Result<Frame> create(const FrameOptions& options, const lighting::Environment& environment);

  const FrameSettings& settings() const { return options_.settings; }
  // Sets the settings from the next step on; only what depends on a changed value runs again. Fails and
  // changes nothing if a value is out of range.
  Result<void> setSettings(const FrameSettings& settings);
  // Makes the next step compute everything anew, as if all had just arrived.
  void forget();

  // Runs a step and draws a picture. Each step gives the environment the suns of the world.
  Result<void> render(World& world, lighting::Environment& environment, const spec::View& view);
  // Runs steps until no light changes any more, at most kMaxRestSteps, without a picture. Returns how many it
  // took.
  Result<std::uint32_t> rest(World& world, lighting::Environment& environment);
  void resize(const spec::Size& size);
  // Draws into textures of other code from now on, if the frame was made for Destination::Shared: linear
  // radiance (GL_RGBA16F or GL_RGBA32F) and depth, of the same size and samples. Their storage stays alive
  // until others are shared. Fails if they are not such.
  Result<void> share(GLuint color, GLuint depth);
  void setShowSky(bool shown) { options_.show_sky = shown; }
  // Returns what the last picture shows at a point, or nothing for the sky. The point is in pixels from the
  // picture's top left corner, so that pixel (i, j) has its centre at (i + 0.5, j + 0.5). Waits for the GPU.
  Result<std::optional<Picked>> pick(World& world, const spec::View& view, float x, float y);

  // Sets the view from the next picture on.
  void setView(const ViewChoice& choice) { options_.view = choice; }
  void setOverlays(OverlayOptions overlays) { options_.overlays = std::move(overlays); }
  // Returns the legend of the last picture.
  ViewLegend legend() const;

  // Return the last picture, with row 0 at the top. They wait for the GPU. Linear pictures have the depths of
  // what wrote to the depth buffer; in views of transfer these include blended surfaces, and with overlays
  // the markers of light probes.
  spec::RgbaImage readLinear() const { return targets_.readLinear(clip_from_view_); }
  spec::Rgba8Image readDisplay() const { return targets_.readDisplay(); }
  // Returns the picture of the last render(), with row 0 at the bottom. It is empty if pictures go to the
  // window.
  const gpu::Texture& picture() const { return targets_.picture(); }
  // Return values of the last picture; they wait for the GPU.
  std::uint32_t negativePixels() const;
  float exposureEv() const;

  gpu::PassTimers& timers() { return timers_; }
  const StepCounts& counts() const { return counts_; }
  // Returns what the passes keep (frame_parts.hpp).
  const FrameParts& parts() const { return *parts_; }
  const FrameOptions& options() const { return options_; }

 private:
  Frame(const FrameOptions& options, std::shared_ptr<FrameParts> parts);

  FrameContext contextOf(World& world, lighting::Environment& environment, const spec::View* view);
  Result<void> step(FrameContext& context);
  Result<void> walk(std::span<const FramePass> passes, FrameContext& context);
  bool atRest(const World& world, const lighting::Environment& environment) const;

  FrameOptions options_;
  std::shared_ptr<FrameParts> parts_;  // owned alone; a shared pointer may hold a type that is not complete
  PictureTargets targets_;
  InvalidationLog log_;
  StepCounts counts_;
  gpu::PassTimers timers_;
  Picker picker_;
  std::uint64_t environment_ = 0;   // version in the last step
  bool settled_ = false;            // whether a step has run since the settings changed
  bool forgotten_ = false;          // whether forget() was called since the last step
  glm::mat4 clip_from_view_{1.0f};  // of the last picture
};

}  // namespace lambent::frame
