#include "baker/transport/seen_origins.hpp"

#include <algorithm>

namespace lambent::baker {

namespace {

// If more first hits of an origin than this share are back faces, it lies inside a body or under something.
constexpr float kInsideShare = 0.5f;
// If more first hits than this share are nearer than the origin's reach, something lies on its face.
constexpr float kCoveredShare = 0.9f;
// If this share of a few rays is blocked, the sample deserves more rays. If all of them are, it most likely
// stands in a closed room, where more rays show nothing more.
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
  const float blocked = rays.meet({all, frame, glances.glance}, shares);
  seen.double_rays = blocked >= kBlockedShare && blocked < 1.0f;
  seen.valid = std::all_of(shares.begin(), shares.end(), [](const MetShares& met) {
    return met.back == 0.0f && met.near <= kCoveredShare;
  });
  if (seen.valid) return;
  rays.meet({all, frame, glances.look}, shares);
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
