#include "baker/transport/seen_origins.hpp"

#include <algorithm>
#include <array>

namespace lambent::baker {

namespace {

// If more first hits of an origin than this share are back faces, it lies inside a body or under something.
constexpr float kInsideShare = 0.5f;
// If more first hits than this share are nearer than the origin's reach, or back faces, something lies on its
// face: a slab, or a hollow body without a bottom, whose rooms show some fronts from inside.
constexpr float kCoveredShare = 0.9f;
// If this share of a few rays is blocked, the sample deserves more rays. If all of them are, it most likely
// stands in a closed room, where more rays show nothing more.
constexpr float kBlockedShare = 0.5f;
constexpr std::size_t kInsideTestRays = 16, kLookRays = 64;
// If no origin is seen, all of them move into their faces by these shares of the way to the middle, until
// one is.
constexpr std::array kMovedInto = {0.0f, 0.1f, 0.3f, 1.0f};

}  // namespace

InsideTestTables::InsideTestTables() : glance(cosineTable(kInsideTestRays)), look(cosineTable(kLookRays)) {}

void findSeenOrigins(std::span<const SampleOrigin> all, const glm::mat3& frame, const RayScene& rays,
                     const InsideTestTables& glances, SeenOrigins& seen) {
  seen.origins.assign(all.begin(), all.end());
  seen.valid = seen.double_rays = false;
  seen.blocked = 0.0f;
  if (all.empty()) return;
  std::vector<MetShares> shares(all.size());
  // Sixteen rays are enough to see that nothing is odd, which is nearly always so.
  seen.blocked = rays.meet({all, frame, glances.glance}, shares);
  seen.double_rays = seen.blocked >= kBlockedShare && seen.blocked < 1.0f;
  seen.valid = std::all_of(shares.begin(), shares.end(), [](const MetShares& met) {
    return met.back == 0.0f && met.near <= kCoveredShare;
  });
  if (seen.valid) return;
  for (const float share : kMovedInto) {
    seen.origins.clear();
    float weight = 0.0f;
    for (const SampleOrigin& origin : all) {
      // Each gets all of the rays. Dealt out by weight, faces that are slivers at the vertex would get none.
      SampleOrigin moved = origin;
      moved.position += share * origin.inward;
      moved.weight = 1.0f;
      MetShares met;
      rays.meet({std::span(&moved, 1), frame, glances.look}, std::span(&met, 1));
      if (met.back > kInsideShare || met.near > kCoveredShare) continue;
      moved.weight = origin.weight;
      weight += origin.weight;
      seen.origins.push_back(moved);
    }
    seen.valid = !seen.origins.empty();
    for (SampleOrigin& origin : seen.origins) origin.weight /= weight;
    if (seen.valid) return;
  }
  seen.origins.assign(all.begin(), all.end());
}

}  // namespace lambent::baker
