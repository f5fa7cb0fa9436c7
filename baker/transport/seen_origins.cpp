#include "baker/transport/seen_origins.hpp"

#include <algorithm>
#include <array>

#include <glm/geometric.hpp>

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
// Whether an origin and its vertex see each other is asked from this share of the origin's reach away from
// the vertex, which may itself lie in another surface.
constexpr float kBeginOfWay = 0.001f;

// Drops origins that something hides from their vertex, unless all are: they stand behind a wall that cuts
// their face, and the light there is not the vertex's.
void dropHiddenFromVertex(const RayScene& rays, std::vector<SampleOrigin>& origins) {
  if (origins.size() < 2) return;
  std::vector<RaySegment> ways;
  for (const SampleOrigin& origin : origins) {
    const glm::vec3 pull = kPullIntoFace / (1.0f - kPullIntoFace) * origin.inward;
    const float whole = glm::length(pull), length = std::max(0.0f, whole - kBeginOfWay * origin.reach);
    const glm::vec3 along = whole > 0.0f ? pull / whole : origin.geometric_normal;
    ways.push_back({origin.position - length * along, along, length});
  }
  std::vector<std::uint8_t> hidden(ways.size(), 0);
  rays.occluded(ways, hidden);
  const auto seen = static_cast<std::size_t>(std::count(hidden.begin(), hidden.end(), 0));
  if (seen == 0 || seen == origins.size()) return;
  float weight = 0.0f;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < origins.size(); ++i) {
    if (hidden[i] != 0) continue;
    weight += origins[i].weight;
    origins[kept++] = origins[i];
  }
  origins.resize(kept);
  for (SampleOrigin& origin : origins) origin.weight /= weight;
}

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
  if (seen.valid) return dropHiddenFromVertex(rays, seen.origins);
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
    if (seen.valid && share == 0.0f) dropHiddenFromVertex(rays, seen.origins);
    if (seen.valid) return;
  }
  seen.origins.assign(all.begin(), all.end());
}

}  // namespace lambent::baker
