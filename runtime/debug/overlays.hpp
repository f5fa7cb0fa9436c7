// Overlays on the GPU: a layer of colours as they shall be seen, over the scene's depth, laid over the
// picture after tone mapping (overlay_options.hpp says what there is). Comes in: the options, the world and
// what the frame knows of its light. Goes out: the bound picture, of which the alpha stays. The parts: lines
// (overlay_lines.hpp), light probes (probe_markers.hpp), slices of neighborhoods, wires
// (data_view.hpp). Render thread only. Errors: shaders that do not compile on this device.
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
  // samples: a pixel of the scene's depth, 0: a plain texture. linear: into a picture of light, with colours
  // to match.
  static Result<Overlays> create(std::uint32_t samples, bool linear);

  // The layer anew, over this depth.
  void attach(const gpu::Texture& depth, const spec::Size& size);
  // What the options ask for; `wires` draws more of the like, blended, after solid things and before lines.
  Result<void> draw(const OverlayOptions& options, const OverlayScene& scene,
                    const std::function<Result<void>()>& wires, gpu::Counters& counters);
  // Over the bound framebuffer.
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
  std::optional<gpu::Program> lines_program_, slices_program_;  // with the first that is drawn
  std::optional<ProbeMarkers> light_probes_;
  gpu::Table lines_, slices_, view_;
  gpu::VertexArray no_vertices_;
};

}  // namespace lambent::frame
