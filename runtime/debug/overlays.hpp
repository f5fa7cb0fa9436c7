// Draws overlays: a layer of display colours over the scene's depth, which is laid over the picture after
// tone mapping (overlay_options.hpp lists them). It takes the options, the world and what the frame knows of
// its light, and writes the bound picture, whose alpha stays. Its parts are lines (overlay_lines.cpp), balls
// at light probes, slices of neighborhoods and wires (data_view.hpp). Render thread only. Fails if a shader
// does not compile on this device.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string_view>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/debug/overlay_options.hpp"
#include "runtime/effects/diffuse/diffuse.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/lighting/group_lights.hpp"
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
  const LitScene& lit_scene;
  const lighting::GroupLights& lights;
  const Neighborhoods& neighborhoods;
  const KeyShadows& key_shadows;
  const ToneMapper& tone_mapper;
  const spec::View& view;
  spec::Size size;
};

// Returns the groups whose neighborhoods are drawn whole (OverlayOptions::foremost_groups), with their
// slices. Boxes that overlap would hide each other. So of those that overlap only the wanted ones and the
// nearest to the eye are whole.
std::vector<std::uint32_t> foremostNeighborhoods(const OverlayOptions& options, const OverlayScene& scene);

// Returns the lines for everything that the options ask for and lines can show, including the options' own
// lines. A key light has its outline on the sky, with its angular radius but at least 1 degree (parallel
// views see a single direction and have none), an arrow into the world along its light, and for some the box
// that the shadow map shows. Weak key lights are fainter than strong ones, and dark ones are grey.
std::vector<OverlayLine> linesOf(const OverlayOptions& options, const OverlayScene& scene);

// Returns the corners of what the shadow map of a key light shows. Bits 1, 2 and 4 of the index select the
// far end along right, up and towards.
std::array<glm::vec3, 8> cornersOf(const KeyRegion& region);

class Overlays {
 public:
  static constexpr std::uint32_t kMaxSigns = 512;

  // `samples` is the number per pixel of the scene's depth, 0 for a plain texture. If `linear` is set, the
  // overlay goes into a picture of light with matching colours.
  static Result<Overlays> create(std::uint32_t samples, bool linear);

  // Makes a new layer over this depth.
  void attach(const gpu::Texture& depth, const spec::Size& size);
  // Draws what the options ask for. At most kMaxSigns light probes are shown, spread over all. `wires` draws
  // further blended content after solid things and before lines.
  Result<void> draw(const OverlayOptions& options, const OverlayScene& scene,
                    const std::function<Result<void>()>& wires, gpu::Counters& counters);
  // Lays the layer over the bound framebuffer.
  void layOver(gpu::Counters& counters);

 private:
  Overlays(std::uint32_t samples, bool linear);
  // Uses the program of this name, whose stages share the file; makes it if it was not drawn yet.
  Result<void> use(std::string_view label, std::string_view file);
  Result<void> drawProbes(const OverlayOptions& options, const OverlayScene& scene, gpu::Counters& counters);
  Result<void> drawSlices(const OverlayOptions& options, const OverlayScene& scene, gpu::Counters& counters);
  Result<void> drawLines(const OverlayOptions& options, const OverlayScene& scene, gpu::Counters& counters);

  std::uint32_t samples_;
  bool linear_;
  spec::Size size_{};
  gpu::Texture color_;
  gpu::Framebuffer target_;
  gpu::Program compose_;
  std::map<std::string_view, gpu::Program> programs_;  // by label
  gpu::Table lines_, slices_, signs_, view_;
  gpu::VertexArray no_vertices_;
};

}  // namespace lambent::frame
