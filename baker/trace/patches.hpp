// Patches: clusters of samples of the same kind (glossy or not) that lie near each other, face alike and are
// about as bright. Light that has been reflected twice and more is smooth enough to be passed on between
// patches (Hanrahan et al. 1991), and what arrives at last is gathered at samples again (patches.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/jobs/bake_context.hpp"
#include "baker/trace/hits.hpp"
#include "baker/trace/transfer_field.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

// A scene has about this many patches at most. Where it has no more samples, each is a patch of its own.
inline constexpr std::size_t kMostPatches = 2048;

struct Patches {
  std::vector<std::uint32_t> of_sample;  // sample -> patch
  std::vector<std::uint32_t> samples;    // patch by patch; those that see nothing (not valid) are left out
  std::vector<std::uint32_t> offsets;    // of each patch's first entry in `samples`, and the end
  std::vector<float> shares;             // beside `samples`: share of the patch's weight; they sum to 1

  // Light of samples relative to that of their patch: how light of later bounces is taken to vary over a
  // patch.
  std::vector<float> profile;

  std::size_t size() const { return offsets.empty() ? 0 : offsets.size() - 1; }
};

// What samples bring to patches, one value each.
struct PatchInputs {
  // Light at the sample, not negative. Patches never join samples whose brightness differs by more than a
  // factor of 16, so that no light gets from a bright room through its wall into a dark one.
  std::span<const float> brightness;
  // Light of the first bounce at the sample, not negative: the profile.
  std::span<const float> bounced;
  // How much the sample counts in its patch. Light that leaves a patch is that of the part of it that others
  // see, so samples count by how much rays met the surface beside them (samplesMet in patches.hpp).
  std::span<const float> weights;
  // 0 if the sample lies inside something; it belongs to the patch of a neighbour.
  std::span<const std::uint8_t> valid;
};

// `edges` are those of sampleEdges(). `diagonal` is that of the group, m.
Patches choosePatches(const SampleSet& samples, float diagonal, const PatchInputs& inputs,
                      std::span<const std::pair<std::uint32_t, std::uint32_t>> edges);

// Light that patches (patches.hpp) pass on: how much of the radiance that leaves each patch arrives at each
// other, and what becomes of transfer between them from one bounce to the next.

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
  const Patches& patches_;
  SamplesOfHit corners_;
  std::size_t channels_;
  std::vector<float> links_;  // [receiver][channel][sender]
};

}  // namespace lambent::baker
