// Gathers one pass of bounces at traced samples: what the pass before left at the points that their rays met.
// What each ray brings is added to the outputs that its hemisphere lists (hemisphere.hpp).
#pragma once

#include <cstddef>
#include <cstdint>

#include "baker/effects/surface/direct.hpp"
#include "baker/trace/exit_radiance.hpp"
#include "baker/trace/glossy_exit.hpp"
#include "baker/trace/patches.hpp"

namespace lambent::baker {

class BounceGather {
 public:
  // `direct` was traced by `pass`; `exit` is that of the surfaces that are met. All must outlive this.
  BounceGather(const DirectPass& pass, const DirectResult& direct, const ExitRadiance& exit)
      : pass_(pass), direct_(direct), exit_(exit) {}

  // Calls `take` with the hits of a sample, their weights and albedos.
  void visitHits(std::size_t sample, const TakeHit& take) const;

  // Gathers at diffuse and normal-mapped samples [begin, end). Adds to `mapped`, which is in the group's
  // frame.
  void matte(const Bounce& bounce, std::size_t begin, std::size_t end, TransferField& now,
             TransferField& mapped) const;

  // Gathers at glossy samples [begin, end), counted from the first. `share` is the largest share of all light
  // that the pass carries.
  void glossy(const Bounce& bounce, double share, std::size_t begin, std::size_t end, GlossyLight& now) const;

 private:
  class GlossyWalk;
  struct Received;
  void gatherMapped(std::size_t sample, const Received& received, std::span<float> out,
                    std::span<float> mapped) const;
  const Hemisphere& hemisphereOf(std::size_t sample) const {
    return pass_.hemisphereOf(sample, direct_.looks.ray_counts[sample]);
  }
  glm::vec3 normalOf(std::size_t sample) const { return pass_.scene().samples.normals[sample]; }

  const DirectPass& pass_;
  const DirectResult& direct_;
  const ExitRadiance& exit_;
};

}  // namespace lambent::baker
