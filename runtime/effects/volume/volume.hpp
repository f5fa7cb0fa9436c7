// Owns the light in volumes on the GPU. It copies the shaded samples of a volume's cells into a 3D texture
// per volume, where marched rays look them up (March). The texture holds the mean radiance that arrives
// at a voxel of the transfer grid or, for anisotropic phase functions, its spherical harmonics convolved with
// the phase function. It takes one indirect dispatch per volume whose samples were shaded. What is not
// resident, and in mode Unshadowed everything, shows the light itself. Without volumes nothing is compiled,
// held or dispatched. Render thread only.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/effects/volume/volume_shared.h"
#include "runtime/evaluate/samples.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/streaming/residency.hpp"

namespace lambent::effects::volume {

using evaluate::TransferMode;

// Describes the arrangement of slabs in a texture: one per output, along z and, where that is full, along x.
struct SlabLayout {
  std::uint32_t slabs_z = 1, slabs_x = 1;
  glm::uvec3 texture_size{1};
};
SlabLayout slabLayoutOf(const glm::uvec3& transfer_size, std::uint32_t outputs);

// The light on groups, and their samples as last shaded under it.
struct ShadedLight {
  const lighting::GroupLights& lights;
  const evaluate::Samples& samples;
};

class Volume {
 public:
  // If `precise` is set, light is stored in floats, for pictures that are compared; otherwise in half floats.
  explicit Volume(bool precise = false);

  // Updates the textures to what was last shaded. Those of volumes for which `in_view` has 0 stay as they are
  // until they come into view; an empty list means that all are. Fails if a kernel does not compile on this
  // device.
  Result<void> shade(streaming::Residency& residency, const ShadedLight& light, evaluate::TransferMode mode,
                     std::span<const std::uint8_t> in_view, gpu::Counters& counters);

  // Returns the texture of residency().volumes()[volume], or a null handle if there is nothing to show yet.
  const gpu::Texture& lightOf(std::size_t volume) const { return held_[volume].light; }
  std::size_t volumeCount() const { return held_.size(); }
  // Counts what the last call wrote.
  struct Shaded {
    std::uint32_t volumes = 0, slabs = 0;
  };
  const Shaded& shadedLast() const { return shaded_; }
  std::uint64_t textureBytes() const;

 private:
  struct Held {
    gpu::Texture light;
    // Compares the versions of shaded samples, of the light of open cells and of the volume, the number of
    // open cells, and the mode.
    ChangeGate<std::uint64_t, std::uint64_t, std::uint64_t, std::uint32_t, TransferMode> changed;
  };

  void collect(const streaming::Residency& residency, const ShadedLight& light, evaluate::TransferMode mode,
               std::span<const std::uint8_t> in_view);
  gpu::Texture makeTexture(const streaming::ResidentVolume& volume) const;

  bool precise_;
  gpu::Programs kernels_;
  KeyedState<Held> held_;  // indexed by volume of the residency
  std::vector<ScatterRecord> records_;
  gpu::Table records_table_;
  gpu::WorkList work_;
  Shaded shaded_;
};

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

// Describes a rectangle in texels from the bottom left. `end` is not in it.
struct Rectangle {
  glm::ivec2 first{0}, end{0};
  bool empty() const { return end.x <= first.x || end.y <= first.y; }
};
// Returns what the box of `size` voxels may cover of the picture; returns all of the picture if the box
// reaches behind the eye.
Rectangle rectangleOf(const glm::mat4& clip_from_grid, const glm::uvec3& size, const spec::Size& picture);

// Draws volumes. Rays through the picture gather the light that the media scatter towards the eye, up to the
// surface behind, and dim that surface. It reads density (residency), the light in the volumes (Volume)
// and the picture's depth. It changes the picture's colour to scattered + T colour and its alpha to 1 - T (1
// - alpha). Overlapping volumes are marched together, up to kMaxMarched at a time; further ones are drawn in
// turn from back to front. Only the rectangle that the volumes fill is drawn. Without a visible volume
// nothing is drawn, compiled or held. Render thread only. Fails if a shader does not compile on this device.
class March {
 public:
  March();

  // Takes the options from the next draw() on.
  void set(const MarchOptions& options) { options_ = options; }
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
  void uploadBlocks(const streaming::Residency& residency, gpu::Counters& counters);
  void makeTargets(const spec::Size& size);
  Result<void> drawBatch(const streaming::Residency& residency, const Volume& light,
                         std::span<const Item> items, const spec::View& view, const Picture& picture,
                         gpu::Counters& counters);

  MarchOptions options_;
  gpu::Programs programs_;
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
