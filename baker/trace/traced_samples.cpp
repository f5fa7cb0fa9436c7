#include "baker/trace/traced_samples.hpp"

#include <algorithm>
#include <utility>

#include <glm/geometric.hpp>

#include "baker/trace/hits.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

namespace {

// If more than this share of the rays hits something, most packets have a ray that hits, and it is faster to
// ask for the closest hit at once than to ask first whether there is one. Either way may choose another of
// two faces where a ray meets their edge, so the choice follows from the sample alone: hits that are traced
// again are the same.
constexpr float kAskWhatAtOnce = 1.0f / 6.0f;

// Few rays are an eighth of the usual number, or as many as a hemisphere needs at least.
constexpr std::size_t kFewer = 8, kLeastRays = 128;

}  // namespace

std::size_t raysOf(RayCount count, std::size_t usual) {
  if (count == RayCount::Twice) return 2 * usual;
  return count == RayCount::Few ? std::max(std::min(usual, kLeastRays), usual / kFewer) : usual;
}

void SampleVisibility::stand(std::size_t s) {
  ray_count_ = RayCount::Usual;
  frame_ = localFrame(glm::normalize(glm::dvec3(scene_.samples.normals[s])));
  if (!scene_.shadows) {
    const auto origins = scene_.samples.originsOf(s);
    seen_.origins.assign(origins.begin(), origins.end());
    seen_.valid = !origins.empty();
    return;
  }
  findSeenOrigins(scene_.samples.originsOf(s), glm::mat3(frame_), scene_.rays, inside_test_, seen_);
  if (seen_.double_rays) ray_count_ = RayCount::Twice;
  if (scene_.importance && !scene_.importance->matters(s)) ray_count_ = RayCount::Few;
}

std::uint32_t SampleVisibility::look(const DirectionTable& table, bool wants_hits, BelowHorizon below) {
  hits_.clear();
  dimmed_.clear();
  blocked_.assign(table.packets(), 0);
  if (seen_.origins.empty()) return 0;
  const SampleRays rays{seen_.origins, glm::mat3(frame_), table, below};
  if (!scene_.shadows) {
    blockBelowHorizons(rays, blocked_);
    return 0;
  }
  const std::uint32_t traced =
      wants_hits ? scene_.rays.traceHits(rays, seen_.blocked > kAskWhatAtOnce, blocked_, hits_)
                 : scene_.rays.trace(rays, blocked_);
  if (scene_.rays.hasPanes()) lookThroughPanes(rays, scene_.rays, scene_.colors, blocked_, hits_, dimmed_);
  return traced;
}

void SampleVisibility::keepHits(std::vector<GatherHit>& out) const {
  for (const RayHit& hit : hits_) {
    GatherHit& kept = out.emplace_back(GatherHit{.triangle = hit.triangle,
                                                 .ray = hit.ray,
                                                 .u = GatherHit::unorm(hit.u),
                                                 .v = GatherHit::unorm(hit.v)});
    kept.setAlbedo(hit.passed);
  }
}

void paintHits(const TracedScene& scene, std::size_t first, const RayDirection& direction, RangeHits& hits) {
  const SurfaceColors& colors = scene.colors;
  std::vector<glm::vec3> passed;  // by the panes before each hit; empty without panes
  std::size_t left = 0;
  for (std::size_t s = 0; s + 1 < hits.offsets.size(); ++s) {
    const std::size_t begin = std::exchange(hits.offsets[s], static_cast<std::uint32_t>(left));
    for (std::size_t h = begin; h < hits.offsets[s + 1]; ++h) {
      GatherHit hit = hits.hits[h];
      // Colours are looked up at the rounded place, so that they are the same whether the hit was traced or
      // found in the cache.
      const glm::vec3 albedo = colors.albedo(hit.triangle, hit.uAt(), hit.vAt());
      // A glossy surface that is black still has a specular reflection.
      if (albedo == glm::vec3(0.0f) && !colors.glossy(hit.triangle)) continue;
      const glm::vec3 before = hit.albedoAt();
      if (before == glm::vec3(0.0f)) continue;
      if (scene.rays.hasPanes()) passed.push_back(before);
      hit.setAlbedo(scene.mirrors ? albedo : before * albedo);
      hits.hits[left++] = hit;
    }
  }
  if (!hits.offsets.empty()) hits.offsets.back() = static_cast<std::uint32_t>(left);
  hits.hits.resize(left);
  if (scene.mirrors) scene.mirrors->follow(first, direction, passed, hits);
}

}  // namespace lambent::baker
