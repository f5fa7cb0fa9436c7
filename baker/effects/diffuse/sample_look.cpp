#include "baker/effects/diffuse/sample_look.hpp"

#include <algorithm>
#include <utility>

#include <glm/geometric.hpp>

#include "baker/transport/frame.hpp"

namespace lambent::baker {

namespace {

// An origin of which more first hits than this are backs lies inside a body or under something.
constexpr float kInsideShare = 0.5f;
// A glance of which so much is blocked asks for a closer look; one that is blocked altogether most likely
// stands in a closed room, where there is nothing more to see.
constexpr float kBlockedShare = 0.5f;
constexpr std::size_t kGlanceRays = 16, kLookRays = 64;
// Where more than one ray in so many hits, most packets have one that does, and to ask at once what they hit
// is faster than to ask first whether they do.
constexpr std::size_t kAskWhatAtOnce = 6;

}  // namespace

GlanceTables::GlanceTables() : glance(cosineTable(kGlanceRays)), look(cosineTable(kLookRays)) {}

void SampleLook::stand(std::size_t s) {
  frame_ = localFrame(glm::normalize(glm::dvec3(samples_.normals[s])));
  valid_ = outsideOrigins(s);
}

std::uint32_t SampleLook::look(const DirectionTable& table, bool wants_hits, BelowHorizon below) {
  hits_.clear();
  blocked_.assign(table.packets(), 0);
  if (origins_.empty()) return 0;
  const glm::mat3 frame(frame_);
  if (!wants_hits) return rays_.trace(origins_, frame, table, blocked_, below);
  const std::uint32_t traced =
      rays_.traceHits(origins_, frame, table, mostly_blocked_, blocked_, hits_, below);
  mostly_blocked_ = kAskWhatAtOnce * hits_.size() > table.size();
  return traced;
}

void SampleLook::keepHits(RangeHits& out) const {
  for (const RayHit& hit : hits_)
    out.hits.push_back({.triangle = hit.triangle,
                        .ray = hit.ray,
                        .u = GatherHit::unorm(hit.u),
                        .v = GatherHit::unorm(hit.v)});
}

void paintHits(const GroupGeometry& geometry, const SampleSet& samples, const SurfaceColors& colors,
               RangeHits& hits) {
  std::size_t left = 0;
  for (std::size_t s = 0; s + 1 < hits.offsets.size(); ++s) {
    const std::size_t begin = std::exchange(hits.offsets[s], static_cast<std::uint32_t>(left));
    for (std::size_t h = begin; h < hits.offsets[s + 1]; ++h) {
      GatherHit hit = hits.hits[h];
      // At the place that is kept, so that a colour is the same whether the hit was traced or found.
      const glm::vec3 albedo = colors.albedo(hit.triangle, static_cast<float>(hit.u) * (1.0f / 65535.0f),
                                             static_cast<float>(hit.v) * (1.0f / 65535.0f));
      // What is glossy and black still mirrors.
      if (albedo == glm::vec3(0.0f) &&
          samples.vertex_sample[geometry.triangles[hit.triangle].x] < samples.first_glossy)
        continue;
      for (int c = 0; c < 3; ++c) hit.albedo[c] = GatherHit::unorm(albedo[c]);
      hits.hits[left++] = hit;
    }
  }
  if (!hits.offsets.empty()) hits.offsets.back() = static_cast<std::uint32_t>(left);
  hits.hits.resize(left);
}

// The origins of a sample that do not lie inside something, weights made to sum to 1; all of them, and
// false, if none is left.
bool SampleLook::outsideOrigins(std::size_t sample) {
  const auto all = samples_.originsOf(sample);
  origins_.assign(all.begin(), all.end());
  closely_ = false;
  if (all.empty()) return false;
  const glm::mat3 frame(frame_);
  std::vector<float> shares(all.size());
  // Sixteen rays are enough to see that nothing is odd, which is nearly always so.
  const float blocked = rays_.backFaceShare(all, frame, glances_.glance, shares);
  closely_ = blocked >= kBlockedShare && blocked < 1.0f;
  if (std::all_of(shares.begin(), shares.end(), [](float share) { return share == 0.0f; })) return true;
  rays_.backFaceShare(all, frame, glances_.look, shares);
  origins_.clear();
  float weight = 0.0f;
  for (std::size_t o = 0; o < all.size(); ++o) {
    if (shares[o] > kInsideShare) continue;
    origins_.push_back(all[o]);
    weight += all[o].weight;
  }
  if (origins_.empty()) {
    origins_.assign(all.begin(), all.end());
    return false;
  }
  for (SampleOrigin& origin : origins_) origin.weight /= weight;
  return true;
}

}  // namespace lambent::baker
