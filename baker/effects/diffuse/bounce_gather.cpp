#include "baker/effects/diffuse/bounce_gather.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include <glm/geometric.hpp>

#include "baker/transport/direction_table.hpp"
#include "runtime/sh/rotation.hpp"

namespace lambent::baker {

// Received are the hits of a sample's rays and the exit radiance towards it. Hits are weighted by `scale`,
// light by way of mirrors by `scale_mirrored`.
struct BounceGather::Received {
  std::span<const GatherHit> hits;
  std::span<const MirroredLight> mirrored;
  float scale, scale_mirrored;
  const Hemisphere& hemisphere;
  const ExitToSample& exit;
};

void BounceGather::visitHits(std::size_t sample, const TakeHit& take) const {
  const Hemisphere& hemisphere = pass_.hemisphereOf(sample, direct_.looks.ray_counts[sample]);
  const StoredHits hits(direct_.hits, pass_, sample, sample + 1);
  const glm::mat3 frame(localFrame(glm::normalize(glm::dvec3(scene_.samples.normals[sample]))));
  const float scale = hits.scaleOf(sample);
  const auto weight_of = [&](std::uint32_t ray) {
    return scale * static_cast<float>(hemisphere.weight(ray));
  };
  for (const GatherHit& hit : hits.of(sample))
    take(hit, weight_of(hit.ray), exit_.albedo(hit, -(frame * hemisphere.direction(hit.ray))));
  exit_.visitMirrored(hits.mirroredOf(sample), weight_of, take);
}

void BounceGather::range(const Bounce& bounce, std::size_t begin, std::size_t end, TransferField& now,
                         TransferField& mapped) const {
  std::vector<GatherHit> thinned;
  std::vector<float> scratch;
  const StoredHits hits(direct_.hits, pass_, begin, end);
  const std::size_t first_mapped = scene_.samples.normal_mapped.begin;
  for (std::size_t s = begin; s < end; ++s) {
    const Hemisphere& hemisphere = pass_.hemisphereOf(s, direct_.looks.ray_counts[s]);
    const ExitToSample exit(bounce, hemisphere.table(), scene_.samples.normals[s], s);
    const float kept = hits.scaleOf(s);
    Received received{hits.of(s), hits.mirroredOf(s), kept, kept, hemisphere, exit};
    if (bounce.thinly) received.scale *= thinHits(bounce.number, hemisphere, received.hits, thinned);
    if (s < first_mapped) {
      exit.addAll(
          received.hits,
          [&](std::uint32_t ray) { return received.scale * static_cast<float>(hemisphere.weight(ray)); },
          now.at(s));
      scratch.resize(now.vectorSize());
      for (const MirroredLight& light : received.mirrored)
        exit.addMirrored(light, kept * static_cast<float>(hemisphere.weight(light.hit.ray)), scratch,
                         now.at(s));
    } else {
      gatherMapped(s, received, now.at(s), mapped.at(s - first_mapped));
    }
  }
}

void BounceGather::gatherMapped(std::size_t sample, const Received& received, std::span<float> out,
                                std::span<float> mapped) const {
  const std::size_t stride = out.size();
  std::vector<float> exit(stride, 0.0f), scratch(stride), local(kIncident * stride, 0.0f);
  // Adds what was found along a ray, and clears it.
  const auto addExit = [&](std::uint32_t ray) {
    const auto weight = static_cast<float>(received.hemisphere.weight(ray));
    for (std::size_t i = 0; i < stride; ++i) out[i] += weight * exit[i];
    const auto& weights = received.hemisphere.incidentWeight(ray);
    for (std::size_t j = 0; j < kIncident; ++j)
      for (std::size_t i = 0; i < stride; ++i) local[j * stride + i] += weights[j] * exit[i];
    std::fill(exit.begin(), exit.end(), 0.0f);
  };
  for (const GatherHit& hit : received.hits) {
    received.exit.add(hit, received.scale, exit);
    addExit(hit.ray);
  }
  for (const MirroredLight& light : received.mirrored) {
    if (!received.exit.brings(light)) continue;
    received.exit.addMirrored(light, received.scale_mirrored, scratch, exit);
    addExit(light.hit.ray);
  }
  if (received.hits.empty() && received.mirrored.empty()) return;
  const sh::Rotation group_from_local(localFrame(glm::normalize(glm::dvec3(scene_.samples.normals[sample]))),
                                      3);
  std::array<float, kIncident> from, to;
  for (std::size_t at = 0; at < stride; ++at) {
    for (std::size_t j = 0; j < kIncident; ++j) from[j] = local[j * stride + at];
    group_from_local.apply(std::span<const float>(from), std::span<float>(to));
    for (std::size_t j = 0; j < kIncident; ++j) mapped[j * stride + at] += to[j];
  }
}

}  // namespace lambent::baker
