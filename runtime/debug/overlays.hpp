// Draws overlays: a layer of display colours over the scene's depth, which is laid over the picture after
// tone mapping (overlay_options.hpp lists them). It takes the options, the world and what the frame knows of
// its light, and writes the bound picture, whose alpha stays. Its parts are lines (overlay_lines.hpp), light
// probes (probe_markers.hpp), slices of neighborhoods and wires (data_view.hpp). Render thread only. Fails if
// a shader does not compile on this device.
#pragma once

#include <functional>
#include <optional>

#include "runtime/base/result.hpp"
#include "runtime/debug/overlay_options.hpp"
#include "runtime/debug/overlay_scene.hpp"
#include "runtime/debug/probe_markers.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/surface/neighborhoods.hpp"

namespace lambent::frame {

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
