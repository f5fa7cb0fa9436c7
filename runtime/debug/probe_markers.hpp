// Light probes as things to look at: at each a cube that shows what a capture sees there, the texels of
// bodies over the sky as it is now, and on top of it a ball whose every point has the radiance that the
// sample's harmonics give in the direction of the ball's normal, as the groups are shaded from it. Captures
// of its own, smaller ones than the light takes, are drawn anew when bodies moved or shine otherwise. At most
// kMaxSigns samples, spread over all. Render thread only. Errors: shaders that do not compile.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/debug/overlay_options.hpp"
#include "runtime/debug/overlay_scene.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/capture.hpp"

namespace lambent::frame {

class ProbeMarkers {
 public:
  static constexpr std::uint32_t kMaxSigns = 512;
  static constexpr std::uint32_t kCubeSize = 16;  // texels along an edge, as light is captured by default

  static Result<ProbeMarkers> create(const std::vector<gpu::Define>& defines);

  // Before the framebuffer is bound: captures change it.
  Result<void> update(const OverlayOptions& options, const OverlayScene& scene, gpu::Counters& counters);
  // Solid, with depth. The view block is bound at kBindView.
  void draw(const OverlayScene& scene, gpu::Counters& counters);

 private:
  // As probe_marker.vert reads it.
  struct Sign {
    glm::vec4 place_and_radius;  // world; of the ball, and half an edge of the cube
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
  std::optional<lighting::Capture> capture_;  // once there are bodies
  std::uint64_t proxies_seen_ = 0;
  std::vector<Sign> signs_;
  std::vector<lighting::CapturePoint> points_;
  // What the cubes were drawn from.
  std::vector<glm::vec4> seen_;
  std::vector<std::uint64_t> shine_seen_;
  gpu::Table table_, record_slots_, discs_;
  gpu::Buffer cubes_;  // vec4 per texel: radiance of bodies, and the share that they hide
  gpu::VertexArray no_vertices_;
};

}  // namespace lambent::frame
