#include "baker/transport/seen_origins.hpp"

#include <algorithm>

namespace lambent::baker {

namespace {

// An origin of which more first hits than this are backs lies inside a body or under something.
constexpr float kInsideShare = 0.5f;
// One of which more first hits than this are on its own face's scale has something lying on it.
constexpr float kCoveredShare = 0.9f;
// A glance of which so much is blocked asks for a closer look; one that is blocked altogether most likely
// stands in a closed room, where there is nothing more to see.
constexpr float kBlockedShare = 0.5f;
constexpr std::size_t kInsideTestRays = 16, kLookRays = 64;

}  // namespace

InsideTestTables::InsideTestTables() : glance(cosineTable(kInsideTestRays)), look(cosineTable(kLookRays)) {}

void findSeenOrigins(std::span<const SampleOrigin> all, const glm::mat3& frame, const RayScene& rays,
                     const InsideTestTables& glances, SeenOrigins& seen) {
  seen.origins.assign(all.begin(), all.end());
  seen.valid = seen.double_rays = false;
  if (all.empty()) return;
  std::vector<MetShares> shares(all.size());
  // Sixteen rays are enough to see that nothing is odd, which is nearly always so.
  const float blocked = rays.meet(all, frame, glances.glance, shares);
  seen.double_rays = blocked >= kBlockedShare && blocked < 1.0f;
  seen.valid = std::all_of(shares.begin(), shares.end(), [](const MetShares& met) {
    return met.back == 0.0f && met.near <= kCoveredShare;
  });
  if (seen.valid) return;
  rays.meet(all, frame, glances.look, shares);
  seen.origins.clear();
  float weight = 0.0f;
  for (std::size_t o = 0; o < all.size(); ++o) {
    if (shares[o].back > kInsideShare || shares[o].near > kCoveredShare) continue;
    seen.origins.push_back(all[o]);
    weight += all[o].weight;
  }
  seen.valid = !seen.origins.empty();
  if (!seen.valid) seen.origins.assign(all.begin(), all.end());
  if (seen.valid)
    for (SampleOrigin& origin : seen.origins) origin.weight /= weight;
}

}  // namespace lambent::baker
