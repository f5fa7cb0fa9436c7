// One frame, from what has arrived to the picture: stream, transforms, light, shade, capture, raster, tone
// map. Every pass runs only if something that it reads is newer than its last output; each is timed and
// counts what it issued. Light that bodies throw on each other travels one step a frame. The picture goes to
// the frame's own target, which can be read back, or to the window's framebuffer. Errors: shaders that do not
// compile, a bundle that turns out damaged while it loads.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/effects/diffuse/diffuse.hpp"
#include "runtime/effects/diffuse/proxies.hpp"
#include "runtime/effects/glossy/glossy.hpp"
#include "runtime/effects/volume/march.hpp"
#include "runtime/effects/volume/volume.hpp"
#include "runtime/frame/lit_scene.hpp"
#include "runtime/frame/near_lights.hpp"
#include "runtime/frame/neighborhoods.hpp"
#include "runtime/frame/surfaces.hpp"
#include "runtime/frame/tone_mapper.hpp"
#include "runtime/frame/world.hpp"
#include "runtime/gpu/pass_timers.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/lighting/incident_light.hpp"
#include "runtime/lighting/reflected_sky.hpp"
#include "runtime/lighting/sky.hpp"
#include "runtime/sh/window.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/spec/size.hpp"

namespace lambent::frame {

enum class Output {
  Linear,  // float RGBA, one ray per pixel centre, textures at full resolution: pictures for comparison
  Display  // tone-mapped, sRGB-coded, four samples per pixel
};

struct FrameOptions {
  spec::Size size;
  Output output = Output::Display;
  bool to_window = false;  // draw into framebuffer 0
  effects::diffuse::TransferMode transfer = effects::diffuse::TransferMode::Full;
  sh::Window window = sh::Window::Auto;
  // Glossy surfaces reflect what the bands of their light leave out of the sky, too.
  bool residual = true;
  // Bodies with grids around them change the light of others by these; else by captures.
  bool neighborhoods = true;
  std::optional<float> exposure_ev;                             // none: automatic
  std::uint64_t upload_budget_bytes = std::uint64_t{16} << 20;  // per frame
  lighting::CaptureOptions capture{.order = 0};                 // order 0: that of the groups' transfer
  std::uint32_t captures_per_step = 16;  // light samples that are drawn anew in a frame, at most
  // Captures arrive in the very next frame, however long that takes: the same pictures on every run.
  bool wait_for_captures = false;
};

// What one step did; a still scene does nothing.
struct StepCounts {
  std::uint32_t groups = 0, bodies = 0, local_lights = 0, near_lights = 0;
  std::uint32_t near_lights_left_out = 0;  // by harmonics instead, once for each group
  lighting::IncidentCounts incident;
  lighting::Capture::Load captured;         // what the captures of this step took
  std::uint32_t light_samples_written = 0;  // coefficients computed for the shaders
  std::uint32_t cells_shaded = 0, draws_shaded = 0;
  std::uint32_t shadow_cubes_drawn = 0;
  // Volumes there are; whose light was brought into their textures, and how many outputs of it; in the
  // picture.
  std::uint32_t volumes = 0, volumes_shaded = 0, volume_slabs_written = 0, volumes_drawn = 0;
  NeighborhoodCounts neighborhoods;
};

// After so many steps a still scene is taken to be at rest: light has gone to and fro as often.
inline constexpr std::uint32_t kMaxRestSteps = 16;

class Frame {
 public:
  static Result<Frame> create(const FrameOptions& options, const lighting::Environment& environment);

  // A step and a picture.
  Result<void> render(World& world, const lighting::Environment& environment, const spec::View& view);
  // Steps until no light changes any more, at most kMaxRestSteps; returns how many it took. No picture.
  Result<std::uint32_t> rest(World& world, const lighting::Environment& environment);
  void resize(const spec::Size& size);

  // Waits for the GPU. Row 0 is the top.
  spec::RgbaImage readLinear() const;
  spec::Rgba8Image readDisplay() const;

  std::uint32_t negativePixels() const { return tone_mapper_.negativePixels(); }
  float exposureEv() const { return tone_mapper_.exposureEv(); }
  gpu::PassTimers& timers() { return timers_; }
  const StepCounts& counts() const { return counts_; }
  // Of what the frame itself keeps for volumes, beside what is resident.
  std::uint64_t volumeBytes() const { return volume_.textureBytes(); }
  const FrameOptions& options() const { return options_; }

 private:
  Frame(const FrameOptions& options, lighting::Sky sky, Surfaces surfaces, ToneMapper tone_mapper);

  Result<void> upload(World& world);
  void transforms(World& world);
  Result<void> step(World& world, const lighting::Environment& environment, std::size_t max_captures);
  Result<void> light(World& world, const lighting::Environment& environment);
  Result<void> shade(World& world);
  Result<void> shadeGlossy(World& world);         // no pass where nothing is glossy
  Result<void> shadeVolumes(World& world);        // these two: no pass without volumes
  Result<void> marchVolumes(World& world, const spec::View& view);
  Result<void> shadeNeighborhoods(World& world);  // no pass without grids
  Result<void> prepareSampling(World& world, const lighting::Environment& environment,
                               gpu::Counters& counters);
  Result<void> capture(World& world, const lighting::Environment& environment, std::size_t max_captures);
  bool atRest(const World& world) const;
  Result<void> reflectSky(const World& world,
                          const lighting::Environment& environment);  // once; no pass then
  Result<void> castShadows(World& world);
  Result<void> raster(World& world, const lighting::Environment& environment, const spec::View& view);
  void toneMap();

  FrameOptions options_;
  lighting::Sky sky_;
  Surfaces surfaces_;
  ToneMapper tone_mapper_;
  effects::diffuse::Diffuse diffuse_;
  effects::glossy::Glossy glossy_;
  effects::volume::Volume volume_;
  std::optional<effects::volume::March> march_;  // once there is a volume
  effects::diffuse::Proxies proxies_;
  LitScene lit_scene_;
  NearLights near_lights_;
  Neighborhoods neighborhoods_;
  std::optional<lighting::ReflectedSky> reflected_sky_;  // once a glossy surface asks for it
  std::optional<lighting::IncidentLight> incident_;      // once there is something to sample
  // How the light that groups send out has changed, summed up.
  struct ProxyRadiance {
    std::uint64_t version = 0, light = 0;
    double drift = 0.0;
  };
  std::vector<ProxyRadiance> proxy_radiance_;
  std::uint64_t proxies_seen_ = 0;
  int capture_order_ = 0;
  lighting::GroupLights group_lights_;
  StepCounts counts_;
  gpu::PassTimers timers_;
  gpu::Texture hdr_, depth_, picture_;
  gpu::Framebuffer hdr_target_, hdr_color_target_, picture_target_;
};

}  // namespace lambent::frame
