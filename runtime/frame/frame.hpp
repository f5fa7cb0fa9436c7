// One frame, from what has arrived to the picture: stream, transforms, light, shade, capture, raster, tone
// map. Every pass runs only if something that it reads is newer than its last output; each is timed and
// counts what it issued and says why. Light that bodies throw on each other travels one step a frame. World,
// environment (also another object) and settings may be changed between frames as one likes. The picture goes
// to the frame's own target, which can be read back, or to the window's framebuffer. Errors: shaders that do
// not compile, a bundle that turns out damaged while it loads.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "runtime/base/keyed_state.hpp"
#include "runtime/base/result.hpp"
#include "runtime/bounces/patch_bounces.hpp"
#include "runtime/debug/data_view.hpp"
#include "runtime/debug/overlays.hpp"
#include "runtime/debug/picker.hpp"
#include "runtime/effects/diffuse/diffuse.hpp"
#include "runtime/effects/diffuse/proxies.hpp"
#include "runtime/effects/glossy/glossy.hpp"
#include "runtime/effects/volume/march.hpp"
#include "runtime/effects/volume/volume.hpp"
#include "runtime/frame/fewer_samples.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/frame/frame_times.hpp"
#include "runtime/frame/invalidation_log.hpp"
#include "runtime/gpu/pass_timers.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/lighting/incident_light.hpp"
#include "runtime/lighting/prefiltered_environment.hpp"
#include "runtime/lighting/sky.hpp"
#include "runtime/shadows/key_shadows.hpp"
#include "runtime/shadows/lit_scene.hpp"
#include "runtime/shadows/local_shadows.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/spec/size.hpp"
#include "runtime/surface/neighborhoods.hpp"
#include "runtime/surface/proxy_lods.hpp"
#include "runtime/surface/surfaces.hpp"
#include "runtime/surface/views.hpp"
#include "runtime/tone_map/tone_mapper.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

enum class Output {
  Linear,  // float RGBA, one ray per pixel centre, textures at full resolution: pictures for comparison
  Display  // tone-mapped, sRGB-coded, four samples per pixel
};

struct FrameOptions {
  spec::Size size;
  Output output = Output::Display;
  bool to_window = false;  // draw into framebuffer 0
  FrameSettings settings{};
  std::uint64_t upload_budget_bytes = std::uint64_t{16} << 20;  // per frame, at most
  // Less than that where frames would take longer than usual.
  bool pace_uploads = true;
  // Captures arrive in the very next frame, however long that takes: the same pictures on every run.
  bool wait_for_captures = false;
  ViewChoice view{};
  OverlayOptions overlays{};
};

// What one step did; a still scene does nothing.
struct StepCounts {
  std::uint32_t groups = 0, bodies = 0, local_lights = 0, shadowed_lights = 0;
  std::uint32_t shadowed_lights_left_out = 0;  // by harmonics instead, once for each group
  lighting::IncidentCounts incident;
  lighting::Capture::Load captured;        // what the captures of this step took
  std::uint32_t light_probes_written = 0;  // coefficients computed for the shaders
  std::uint32_t cells_shaded = 0, draws_shaded = 0;
  std::uint32_t shadow_cubes_drawn = 0;
  PatchBounceCounts patch_bounces;
  std::uint32_t key_lights = 0, key_maps_drawn = 0;
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
  ViewLegend legend() const { return data_view_ ? data_view_->legend() : legendOf(options_.view, 0.0f); }
  // Null where no view of transfer is shown.
  const effects::diffuse::TransferValues* transferValues() const {
    return data_view_ ? &data_view_->values() : nullptr;
  }

  // Waits for the GPU. Row 0 is the top. Linear pictures have depths, of what wrote to the depth buffer: in
  // views of transfer blended surfaces too, with overlays the signs of light probes.
  spec::RgbaImage readLinear() const;
  spec::Rgba8Image readDisplay() const;

  // What the last render() left, where it does not go to the window; row 0 is the bottom.
  const gpu::Texture& picture() const { return picture_; }

  std::uint32_t negativePixels() const { return tone_mapper_.negativePixels(); }
  float exposureEv() const { return tone_mapper_.exposureEv(); }
  gpu::PassTimers& timers() { return timers_; }
  const StepCounts& counts() const { return counts_; }
  // Of what the frame itself keeps for volumes, beside what is resident.
  std::uint64_t volumeBytes() const { return volume_.textureBytes(); }
  std::uint64_t patchBounceBytes() const { return patch_bounces_.bytesResident(); }
  const KeyShadows& keyShadows() const { return key_shadows_; }
  const FrameOptions& options() const { return options_; }
  // From one render() to the next.
  const FrameTimes& frameTimes() const { return pacer_.times(); }

 private:
  Frame(const FrameOptions& options, lighting::Sky sky, Surfaces surfaces, ToneMapper tone_mapper);

  Result<void> upload(World& world);
  void transforms(World& world);
  Result<void> step(World& world, const lighting::Environment& environment, std::size_t max_captures);
  Result<void> light(World& world, const lighting::Environment& environment);
  void keepFewerSamples(const World& world);
  std::vector<lighting::Incident> incidentOf(const World& world, std::size_t group) const;
  Result<void> shade(World& world);
  Result<void> bounce(World& world,
                      const lighting::Environment& environment);  // no pass without local lights
  Result<void> shadeGlossy(World& world);                         // no pass where nothing is glossy
  Result<void> shadeVolumes(World& world);                        // these two: no pass without volumes
  Result<void> marchVolumes(World& world, const spec::View& view);
  Result<void> shadeNeighborhoods(World& world);  // no pass without grids
  Result<void> prepareSampling(World& world, const lighting::Environment& environment,
                               gpu::Counters& counters);
  Result<void> capture(World& world, const lighting::Environment& environment, std::size_t max_captures);
  bool atRest(const World& world, const lighting::Environment& environment) const;
  Result<void> reflectSky(const World& world,
                          const lighting::Environment& environment);  // once per light; no pass then
  void updateSky(const lighting::Environment& environment);           // no pass where it is up to date
  Result<void> castShadows(World& world);
  // Direct light of key lights comes by shadow maps; unshadowed light has no use for them.
  bool keysApart() const { return options_.settings.transfer != effects::diffuse::TransferMode::Unshadowed; }
  Result<void> castKeyShadows(World& world, const lighting::Environment& environment, const spec::View& view);
  Result<void> raster(World& world, const lighting::Environment& environment, const spec::View& view);
  void clearPicture();
  Result<void> prepareSurfaces(World& world, const lighting::Environment& environment, const spec::View& view,
                               gpu::Counters& counters);
  // In place of light.
  Result<void> drawNumbers(World& world, const spec::View& view, gpu::Counters& counters);
  void toneMap();
  Result<void> drawOverlays(World& world, const lighting::Environment& environment, const spec::View& view);

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
  LocalShadows local_shadows_;
  PatchBounces patch_bounces_;
  KeyShadows key_shadows_;
  ProxyLods proxy_lods_;
  Neighborhoods neighborhoods_;
  std::optional<lighting::PrefilteredEnvironment>
      prefiltered_environment_;                      // once a glossy surface asks for it
  std::optional<lighting::IncidentLight> incident_;  // once there is something to sample
  // How the light that groups send out has changed, summed up.
  struct ProxyRadiance {
    std::uint64_t version = 0, light = 0;
    double lamps = 0.0, drift = 0.0;
  };
  KeyedState<ProxyRadiance> proxy_radiance_;
  std::uint64_t proxies_seen_ = 0;
  int capture_order_ = 0;
  static constexpr std::size_t kAllCaptures = ~std::size_t{0};
  std::uint64_t structure_captured_ = 0;     // of the residency, when captures were last asked for
  bool captures_waited_ = false;             // for one step, as the structure had changed
  std::vector<FewerSamples> fewer_samples_;  // per group; empty: all are kept
  std::uint64_t environment_seen_ = 0, reflected_lights_ = 0;
  bool forgotten_ = false;
  bool settled_ = false;  // whether a step has run since the settings changed
  InvalidationLog invalidation_log_;
  Picker picker_;
  lighting::GroupLights group_lights_;
  StepCounts counts_;
  std::optional<DataView> data_view_;  // while a view shows transfer
  std::optional<DataView> wires_;      // while a view shows wires
  std::optional<Overlays> overlays_;   // while any are shown
  UploadPacer pacer_;
  std::optional<std::chrono::steady_clock::time_point> rendered_;  // the last time
  std::uint64_t uploaded_bytes_ = 0;                               // since then
  glm::mat4 clip_from_view_{1.0f};                                 // of the last picture
  gpu::PassTimers timers_;
  gpu::Texture hdr_, depth_, picture_;
  gpu::Framebuffer hdr_target_, hdr_color_target_, picture_target_;
};

}  // namespace lambent::frame
