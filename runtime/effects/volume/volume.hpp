// The light in volumes on the GPU. The samples of a volume's cells are shaded by the diffuse effect (outputs
// 1 and 9) or the glossy one (more); this one brings them into a 3D texture per volume, where rays through
// the volume find them (march.hpp): mean radiance that arrives at a voxel of the transfer grid, or, for phase
// functions that look ahead, its spherical harmonics, convolved with the phase function. One indirect
// dispatch per volume whose samples were shaded anew; nothing changed: none. What is not resident, and all of
// it when unshadowed, shows the light itself. Without volumes nothing is compiled, held or dispatched.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "runtime/base/keyed_state.hpp"
#include "runtime/base/result.hpp"
#include "runtime/effects/diffuse/diffuse.hpp"
#include "runtime/effects/glossy/glossy.hpp"
#include "runtime/effects/volume/volume_shared.h"
#include "runtime/gpu/program.hpp"
#include "runtime/gpu/work_list.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/streaming/residency.hpp"

namespace lambent::effects::volume {

using diffuse::TransferMode;

// How the slabs of a texture stand: one per output, along z and, past the end of a texture, along x.
struct SlabLayout {
  std::uint32_t slabs_z = 1, slabs_x = 1;
  glm::uvec3 texture_size{1};
};
SlabLayout slabLayoutOf(const glm::uvec3& transfer_size, std::uint32_t outputs);

class Volume {
 public:
  // precise: light in floats, for pictures that are compared; else in half floats.
  explicit Volume(bool precise = false);

  // Brings the textures up to date with what the other effects last shaded, after they have. Errors: a kernel
  // that does not compile on this device.
  Result<void> shade(streaming::Residency& residency, const lighting::GroupLights& lights,
                     const diffuse::Diffuse& diffuse, const glossy::Glossy& glossy, TransferMode mode,
                     gpu::Counters& counters);

  // Of residency().volumes()[volume]; an empty handle: nothing to show yet.
  const gpu::Texture& lightOf(std::size_t volume) const { return held_[volume].light; }
  std::size_t volumeCount() const { return held_.size(); }
  // What the last call wrote.
  struct Shaded {
    std::uint32_t volumes = 0, slabs = 0;
  };
  const Shaded& shadedLast() const { return shaded_; }
  std::uint64_t textureBytes() const;

 private:
  // What a texture was written from.
  struct Seen {
    std::uint64_t shaded = 0, light = 0, version = 0;
    std::uint32_t open_cells = 0;
    TransferMode mode = TransferMode::Full;
    bool operator==(const Seen&) const = default;
  };
  struct Held {
    gpu::Texture light;
    Seen seen;
  };

  void collect(const streaming::Residency& residency, const lighting::GroupLights& lights,
               const diffuse::Diffuse& diffuse, const glossy::Glossy& glossy, TransferMode mode);
  gpu::Texture makeTexture(const streaming::ResidentVolume& volume) const;

  bool precise_;
  std::optional<gpu::Program> program_;
  KeyedState<Held> held_;  // index: residency volume
  std::vector<ScatterRecord> records_;
  gpu::Table records_table_;
  gpu::WorkList work_;
  Shaded shaded_;
};

}  // namespace lambent::effects::volume
