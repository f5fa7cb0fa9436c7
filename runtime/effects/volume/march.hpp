// Draws volumes. Rays through the picture gather the light that the media scatter towards the eye, up to the
// surface behind, and dim that surface. It reads density (residency), the light in the volumes (volume.hpp)
// and the picture's depth. It changes the picture's colour to scattered + T colour and its alpha to 1 - T (1
// - alpha). Overlapping volumes are marched together, up to kMaxMarched at a time; further ones are drawn in
// turn from back to front. Only the rectangle that the volumes fill is drawn. Without a visible volume
// nothing is drawn, compiled or held. Render thread only. Fails if a shader does not compile on this device.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/effects/volume/volume.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/spec/camera.hpp"

namespace lambent::effects::volume {

struct MarchOptions {
  // A step is this many voxels of the finest density at that place. The picture hardly depends on it: half of
  // it changes clouds, however dense, by less than 0.5 % (RMS), thin ones by less than 0.1 %.
  float step_voxels = 1.0f;
  // Steps begin at a different offset in each pixel, the same in every frame, so that their error does not
  // show as bands.
  bool jitter = true;
};

// Names a volume and the placement of its group.
struct PlacedVolume {
  std::uint32_t volume = 0;  // index in the residency
  glm::mat4 world_from_group{1.0f};
};

struct Picture {
  const gpu::Framebuffer& color;  // without depth, because the shader reads it
  const gpu::Texture& depth;      // 2D, with one or several samples per pixel
  spec::Size size;
};

// Describes the volume to the march, for rays in view space. Returns nothing if the volume has no extent.
std::optional<MarchRecord> describeMarch(const streaming::ResidentVolume& volume,
                                         const glm::mat4& world_from_group, const glm::mat4& view_from_world);

// Describes a rectangle in texels from the bottom left.
struct Rectangle {
  std::int32_t x = 0, y = 0, width = 0, height = 0;
  bool empty() const { return width <= 0 || height <= 0; }
};
// Returns what the box of `size` voxels may cover of the picture; returns all of the picture if the box
// reaches behind the eye.
Rectangle rectangleOf(const glm::mat4& clip_from_grid, const glm::uvec3& size, const spec::Size& picture);

class March {
 public:
  explicit March(const MarchOptions& options);
  void setStep(float step_voxels) { options_.step_voxels = step_voxels; }

  Result<void> draw(const streaming::Residency& residency, const Volume& light,
                    std::span<const PlacedVolume> volumes, const spec::View& view, const Picture& picture,
                    gpu::Counters& counters);
  // Returns how many volumes the last call drew.
  std::uint32_t drawnLast() const { return drawn_; }

 private:
  struct Item {
    std::uint32_t volume = 0;
    MarchRecord record;
    Rectangle rectangle;
    float distance = 0.0f;
  };
  struct Kind {
    std::uint32_t volumes = 1, bands = 1, samples = 0;
    auto operator<=>(const Kind&) const = default;
  };
  Result<const gpu::Program*> program(const Kind& kind);
  Result<const gpu::Program*> compositeProgram(std::uint32_t samples);
  void uploadBlocks(const streaming::Residency& residency, gpu::Counters& counters);
  void makeTargets(const spec::Size& size);
  Result<void> drawBatch(const streaming::Residency& residency, const Volume& light,
                         std::span<const Item> items, const spec::View& view, const Picture& picture,
                         gpu::Counters& counters);

  MarchOptions options_;
  std::map<Kind, gpu::Program> programs_;
  std::map<std::uint32_t, gpu::Program> composites_;  // keyed by samples per pixel
  gpu::Table records_, blocks_;
  std::vector<std::uint32_t> first_block_;                 // index: residency volume
  ChangeGate<std::vector<std::uint64_t>> blocks_changed_;  // versions of the volumes
  gpu::VertexArray no_vertices_;
  // For pictures with several samples, it holds the march up to the nearest and to the farthest sample of a
  // pixel.
  gpu::Texture marched_;
  gpu::Framebuffer marched_target_;
  std::uint32_t drawn_ = 0;
};

}  // namespace lambent::effects::volume
