// Draws volumes: rays through the picture gather what the media scatter towards the eye, as far as the
// surface that stands there, and dim what is behind. Reads density (residency), the light in the volumes
// (volume.hpp) and the picture's depth; changes its colour: scattered + T colour, alpha 1 - T (1 - alpha).
// Volumes that overlap are marched together, kMaxMarched at a time; more are drawn in turn from the back.
// Only the rectangle that they fill is drawn, and without a volume in sight nothing is, nor compiled, nor
// held. Errors: a shader that does not compile on this device.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>

#include "runtime/base/result.hpp"
#include "runtime/effects/volume/volume.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/size.hpp"

namespace lambent::effects::volume {

struct MarchOptions {
  // A step, in voxels of the density of the finest volume there. The picture does not depend on it: half of
  // it changes clouds, however dense, by less than 0.5 % (RMS), thin ones by less than 0.1 %.
  float step_voxels = 1.0f;
  // Steps begin elsewhere in each pixel, the same in every frame: what is left of them cannot be seen as
  // bands.
  bool jitter = true;
};

// Where a volume's group stands.
struct PlacedVolume {
  std::uint32_t volume = 0;  // of the residency
  glm::mat4 world_from_group{1.0f};
};

struct Picture {
  const gpu::Framebuffer& color;  // without depth, which is read
  const gpu::Texture& depth;      // 2D, with several samples a pixel or one
  spec::Size size;
};

// The volume as rays meet it, in the first two metres and grids; none where it has no extent.
std::optional<MarchRecord> describeMarch(const streaming::ResidentVolume& volume,
                                         const glm::mat4& world_from_group, const glm::mat4& view_from_world);

// Texels from the bottom left.
struct Rectangle {
  std::int32_t x = 0, y = 0, width = 0, height = 0;
  bool empty() const { return width <= 0 || height <= 0; }
};
// What the box of `size` voxels may fill of the picture; all of it where it reaches behind the eye.
Rectangle rectangleOf(const glm::mat4& clip_from_grid, const glm::uvec3& size, const spec::Size& picture);

class March {
 public:
  explicit March(const MarchOptions& options);
  void setStep(float step_voxels) { options_.step_voxels = step_voxels; }

  Result<void> draw(const streaming::Residency& residency, const Volume& light,
                    std::span<const PlacedVolume> volumes, const spec::View& view, const Picture& picture,
                    gpu::Counters& counters);
  // Volumes that the last call drew.
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
  std::map<std::uint32_t, gpu::Program> composites_;  // by samples
  gpu::Table records_, blocks_;
  std::vector<std::uint32_t> first_block_;  // index: residency volume
  std::vector<std::uint64_t> blocks_seen_;  // versions of the volumes
  gpu::VertexArray no_vertices_;
  // Of pictures of several samples: what was marched before the nearest and the farthest of a pixel.
  gpu::Texture marched_;
  gpu::Framebuffer marched_target_;
  std::uint32_t drawn_ = 0;
};

}  // namespace lambent::effects::volume
