// Patches: clusters of samples that lie near each other, face alike and are about as bright. Light that has
// been reflected twice and more is smooth enough to be passed on between patches (Hanrahan, Salzman and
// Aupperle 1991, "A Rapid Hierarchical Radiosity Algorithm"), and what arrives at last is gathered at samples
// again (patch_light.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

// A scene has about this many patches at most. Where it has no more samples, each is a patch of its own.
inline constexpr std::size_t kMostPatches = 2048;

struct Patches {
  std::vector<std::uint32_t> of_sample;  // sample -> patch
  std::vector<std::uint32_t> samples;    // patch by patch; those that see nothing (not valid) are left out
  std::vector<std::uint32_t> offsets;    // of each patch's first entry in `samples`, and the end
  std::vector<float> shares;             // beside `samples`: share of the patch's area; they sum to 1

  std::size_t size() const { return offsets.empty() ? 0 : offsets.size() - 1; }
};

// brightness: of each sample, not negative. Patches never join samples whose brightness differs by more than
// a factor of 16, so that no light gets from a bright room through its wall into a dark one. valid: 0 where a
// sample lies inside something; it belongs to the patch of a neighbour. `edges` are those of sampleEdges().
Patches choosePatches(const GroupGeometry& geometry, const SampleSet& samples,
                      std::span<const float> brightness, std::span<const std::uint8_t> valid,
                      std::span<const std::pair<std::uint32_t, std::uint32_t>> edges);

}  // namespace lambent::baker
