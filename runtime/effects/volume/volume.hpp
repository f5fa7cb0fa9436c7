// Owns the light in volumes on the GPU. It copies the shaded samples of a volume's cells into a 3D texture
// per volume, where marched rays look them up (march.hpp). The texture holds the mean radiance that arrives
// at a voxel of the transfer grid or, for anisotropic phase functions, its spherical harmonics convolved with
// the phase function. It takes one indirect dispatch per volume whose samples were shaded. What is not
// resident, and in mode Unshadowed everything, shows the light itself. Without volumes nothing is compiled,
// held or dispatched. Render thread only.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/effects/volume/volume_shared.h"
#include "runtime/evaluate/kernels.hpp"
#include "runtime/evaluate/samples.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/streaming/residency.hpp"

namespace lambent::effects::volume {

// The tables of GLSL text that programs of this room include files from.
extern const gpu::FindText kVolumeShaders[1];

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

  // Updates the textures to what was last shaded. Those of volumes for
  // which `in_view` has 0 stay as they are until they come into view; an empty list means that all are. Fails
  // if a kernel does not compile on this device.
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
  evaluate::Kernels kernels_{kVolumeShaders};
  KeyedState<Held> held_;  // indexed by volume of the residency
  std::vector<ScatterRecord> records_;
  gpu::Table records_table_;
  gpu::WorkList work_;
  Shaded shaded_;
};

}  // namespace lambent::effects::volume
