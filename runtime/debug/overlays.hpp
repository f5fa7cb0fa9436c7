// Draws overlays: a layer of display colours over the scene's depth, which is laid over the picture after
// tone mapping (overlay_options.hpp lists them). It takes the options, the world and what the frame knows of
// its light, and writes the bound picture, whose alpha stays. Its parts are lines (overlay_lines.hpp), light
// probes (ProbeMarkers), slices of neighborhoods and wires (data_view.hpp). Render thread only. Fails if
// a shader does not compile on this device.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/debug/overlay_options.hpp"
#include "runtime/effects/diffuse/diffuse.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/capture.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/lighting/sky.hpp"
#include "runtime/shadows/key_shadows.hpp"
#include "runtime/shadows/lit_scene.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/surface/neighborhoods.hpp"
#include "runtime/tone_map/tone_mapper.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// The tables of GLSL text that programs of this room include files from.
extern const gpu::FindText kDebugShaders[9];

// Describes what overlays read of a frame, as references that are valid during one draw. Types only.
struct OverlayScene {
  World& world;
  const lighting::Environment& environment;
  const lighting::Sky& sky;
  const LitScene& lit_scene;
  const lighting::GroupLights& lights;
  const Neighborhoods& neighborhoods;
  const KeyShadows& key_shadows;
  const effects::diffuse::Proxies& proxies;
  const ToneMapper& tone_mapper;
  const spec::View& view;
  spec::Size size;
};

// Draws markers for light probes. Each is a cube that shows what a capture sees there (bodies over the
// current sky), and on top of it a ball. A point of the ball has the radiance that the probe's harmonics give
// in the direction of its normal, as groups are shaded with them. The markers have captures of their own,
// smaller than those for the light, which are drawn again when bodies moved or shine differently. At most
// kMaxSigns probes are shown, spread over all. Render thread only. Fails if a shader does not compile.
class ProbeMarkers {
 public:
  static constexpr std::uint32_t kMaxSigns = 512;
  static constexpr std::uint32_t kCubeSize = 16;  // texels along an edge; the default size of captures

  static Result<ProbeMarkers> create(const std::vector<gpu::Define>& defines);

  // Call it before the framebuffer is bound, because captures change that.
  Result<void> update(const OverlayOptions& options, const OverlayScene& scene, gpu::Counters& counters);
  // Draws solid markers with depth. The view block must be bound at kBindView.
  void draw(const OverlayScene& scene, gpu::Counters& counters);

 private:
  // Has the layout that probe_marker.vert reads.
  struct Sign {
    glm::vec4 place_and_radius;  // world; w: radius of the ball, half an edge of the cube
    glm::vec4 group_from_world;  // rotation, xyzw
    std::uint32_t light;         // vec4 index of its coefficients
    std::uint32_t order;
    std::uint32_t pad[2];
    bool operator==(const Sign&) const = default;
  };

  ProbeMarkers();
  void place(const OverlayOptions& options, const OverlayScene& scene);
  Result<void> capture(const OverlayScene& scene, gpu::Counters& counters);

  gpu::Program program_, gather_program_;
  std::optional<lighting::Capture> capture_;  // made once there are bodies
  ChangeGate<std::uint64_t> proxies_changed_;
  std::vector<Sign> signs_;
  std::vector<lighting::CapturePoint> points_;
  ChangeGate<std::vector<glm::vec4>, std::vector<std::uint64_t>> cubes_changed_;  // places, light
  gpu::Table table_, record_slots_, discs_;
  gpu::Buffer cubes_;  // vec4 per texel: radiance of bodies, share that they hide
  gpu::VertexArray no_vertices_;
};

class Overlays {
 public:
  // `samples` is the number per pixel of the scene's depth, 0 for a plain texture. If `linear` is set, the
  // overlay goes into a picture of light with matching colours.
  static Result<Overlays> create(std::uint32_t samples, bool linear);

  // Makes a new layer over this depth.
  void attach(const gpu::Texture& depth, const spec::Size& size);
  // Draws what the options ask for. `wires` draws further blended content after solid things and before
  // lines.
  Result<void> draw(const OverlayOptions& options, const OverlayScene& scene,
                    const std::function<Result<void>()>& wires, gpu::Counters& counters);
  // Lays the layer over the bound framebuffer.
  void layOver(gpu::Counters& counters);

 private:
  Overlays(std::uint32_t samples, bool linear);
  std::vector<gpu::Define> defines() const;
  Result<void> drawSlices(const OverlayOptions& options, const OverlayScene& scene, gpu::Counters& counters);
  Result<void> drawLines(const OverlayOptions& options, const OverlayScene& scene, gpu::Counters& counters);

  std::uint32_t samples_;
  bool linear_;
  spec::Size size_{};
  gpu::Texture color_;
  gpu::Framebuffer target_;
  gpu::Program compose_;
  std::optional<gpu::Program> lines_program_, slices_program_;  // made when first drawn
  std::optional<ProbeMarkers> light_probes_;
  gpu::Table lines_, slices_, view_;
  gpu::VertexArray no_vertices_;
};

}  // namespace lambent::frame
