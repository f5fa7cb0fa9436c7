// Draws overlays: a layer of display colours over the scene's depth, which is laid over the picture after
// tone mapping (OverlayOptions lists them). It takes the options, the world and what the frame knows of
// its light, and writes the bound picture, whose alpha stays. Its parts are lines, balls
// at light probes and wires (data_view.hpp). Render thread only. Fails if a shader
// does not compile on this device.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/debug/data_view.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/surface/neighborhoods.hpp"
#include "runtime/surface/views.hpp"
#include "runtime/tone_map/tone_mapper.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// The tables of GLSL text that programs of this room include files from.
extern const gpu::FindText kDebugShaders[8];

// Describes what overlays read of a frame, as references that are valid during one draw. Types only.
struct OverlayScene {
  World& world;
  const lighting::Environment& environment;
  const LightPlan& light_plan;
  const lighting::GroupLights& lights;
  const Neighborhoods& neighborhoods;
  const ToneMapper& tone_mapper;
  const spec::View& view;
};

class Overlays {
 public:
  static constexpr std::uint32_t kMaxSigns = 512;

  // Makes a layer over this depth. If `linear` is set, it goes into a picture of light with matching colours.
  Overlays(const gpu::Texture& depth, const spec::Size& size, bool linear);

  // Draws what the options ask for. At most kMaxSigns light probes are shown, spread over all. Wires, if not
  // null, are drawn after solid things and before lines.
  Result<void> draw(const OverlayOptions& options, const OverlayScene& scene, DataView* wires,
                    gpu::Counters& counters);
  // Lays the layer over the bound framebuffer.
  Result<void> layOver(gpu::Counters& counters);

 private:
  Result<void> use(std::string_view file);  // both stages share it
  Result<void> drawProbes(const OverlayOptions& options, const OverlayScene& scene, gpu::Counters& counters);
  Result<void> drawLines(const OverlayOptions& options, const OverlayScene& scene, gpu::Counters& counters);

  spec::Size size_;
  gpu::Texture color_;
  gpu::Framebuffer target_;
  gpu::Programs programs_;
  std::vector<gpu::Define> defines_;
  gpu::Table lines_, signs_, view_;
  gpu::VertexArray no_vertices_;
};

}  // namespace lambent::frame
