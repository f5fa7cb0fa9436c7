// Light that patches (patches.hpp) pass on: how much of the radiance that leaves each patch arrives at each
// other, and what becomes of transfer between them from one bounce to the next.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/jobs/bake_context.hpp"
#include "baker/trace/hits.hpp"
#include "baker/trace/patches.hpp"
#include "baker/trace/transfer_field.hpp"

namespace lambent::baker {

// Transfer of patches, as light that leaves the points that rays met: it is looked up by their samples.
struct PatchRadiance {
  const Patches& patches;
  TransferField field;  // one vector per patch, laid out as those of samples
};

// Takes a hit of a sample, by how much its radiance counts in E/pi there (they sum to at most 1), and how
// much of the light that arrives at the hit it sends back.
using TakeHit = std::function<void(const GatherHit& hit, float weight, const glm::vec3& albedo)>;

// Returns the samples whose light a hit shows, by the weights of its triangle's corners.
using SamplesOfHit = std::function<glm::uvec3(const GatherHit& hit)>;

// Calls take for all hits of a sample; called from many threads.
using VisitHits = std::function<void(std::size_t sample, const TakeHit& take)>;

// Returns how much light the surface beside each sample sends to all others: the sum over hits of the
// receiver's area times the hit's weight and albedo, a corner's part for each. Nothing if stopped. `areas`
// are those of sampleAreas(). The result does not depend on the number
// of threads.
std::optional<std::vector<float>> samplesMet(std::span<const float> areas, const SamplesOfHit& corners,
                                             const VisitHits& visit, const BakeContext& context);

class PatchTransport {
 public:
  // Patches outlive it.
  PatchTransport(const Patches& patches, SamplesOfHit corners, std::size_t channels)
      : patches_(patches), corners_(std::move(corners)), channels_(channels) {}

  // Follows the hits of all samples once. Returns false if stopped. Nothing is kept in the cache.
  bool build(const VisitHits& visit, const BakeContext& context);

  // Returns the means over patches of what samples have.
  TransferField meansOf(const TransferField& samples) const;
  // Returns what arrives at patches of what leaves them: the next bounce.
  TransferField bounce(const TransferField& before) const;

 private:
  std::span<float> row(std::size_t patch) {
    return std::span(links_).subspan(patch * channels_ * patches_.size(), channels_ * patches_.size());
  }

  const Patches& patches_;
  SamplesOfHit corners_;
  std::size_t channels_;
  std::vector<float> links_;  // [receiver][channel][sender]
};

}  // namespace lambent::baker
