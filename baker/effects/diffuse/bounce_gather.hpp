// Gathers one pass of bounces at diffuse samples: what the pass before left at the points that their rays
// met.
#pragma once

#include <cstddef>
#include <span>

#include "baker/effects/diffuse/direct.hpp"
#include "baker/trace/exit_radiance.hpp"
#include "baker/trace/patches.hpp"

namespace lambent::baker {

class BounceGather {
 public:
  // `direct` was traced by `pass` at the samples of `scene`; `exit` is that of the surfaces that are met. All
  // must outlive this.
  BounceGather(const DirectPass& pass, const DirectResult& direct, const TracedScene& scene,
               const ExitRadiance& exit)
      : pass_(pass), direct_(direct), scene_(scene), exit_(exit) {}

  // Calls `take` with the hits of a sample, their weights and albedos.
  void visitHits(std::size_t sample, const TakeHit& take) const;

  // Gathers at samples [begin, end). Adds to `mapped`, which is in the group's frame.
  void range(const Bounce& bounce, std::size_t begin, std::size_t end, TransferField& now,
             TransferField& mapped) const;

 private:
  struct Received;
  void gatherMapped(std::size_t sample, const Received& received, std::span<float> out,
                    std::span<float> mapped) const;

  const DirectPass& pass_;
  const DirectResult& direct_;
  const TracedScene& scene_;
  const ExitRadiance& exit_;
};

}  // namespace lambent::baker
