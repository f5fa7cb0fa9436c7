// Patches: clusters of samples of the same kind (glossy or not) that lie near each other, face alike and are
// about as bright. Light that has been reflected twice and more is smooth enough to be passed on between
// patches (Hanrahan et al. 1991), and what arrives at last is gathered at samples again (patch_light.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

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
  // see, so samples count by how much rays met the surface beside them (samplesMet in patch_light.hpp).
  std::span<const float> weights;
  // 0 if the sample lies inside something; it belongs to the patch of a neighbour.
  std::span<const std::uint8_t> valid;
};

// `edges` are those of sampleEdges(). `diagonal` is that of the group, m.
Patches choosePatches(const SampleSet& samples, float diagonal, const PatchInputs& inputs,
                      std::span<const std::pair<std::uint32_t, std::uint32_t>> edges);

}  // namespace lambent::baker
