// Draws markers for light probes. Each is a cube that shows what a capture sees there (bodies over the
// current sky), and on top of it a ball. A point of the ball has the radiance that the probe's harmonics give
// in the direction of its normal, as groups are shaded with them. The markers have captures of their own,
// smaller than those for the light, which are drawn again when bodies moved or shine differently. At most
// kMaxSigns probes are shown, spread over all. Render thread only. Fails if a shader does not compile.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/debug/overlay_options.hpp"
#include "runtime/debug/overlay_scene.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/capture.hpp"

namespace lambent::frame {

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

}  // namespace lambent::frame
