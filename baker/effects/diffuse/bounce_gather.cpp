#include "baker/effects/diffuse/bounce_gather.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include <glm/geometric.hpp>

#include "baker/transport/frame.hpp"
#include "runtime/sh/rotation.hpp"

namespace lambent::baker {

// Received are the hits of a sample's rays and the exit radiance towards it; hits are weighted by `scale`.
struct BounceGather::Received {
  std::span<const GatherHit> hits;
  float scale;
  const Hemisphere& hemisphere;
  const ExitToSample& exit;
};

void BounceGather::visitHits(std::size_t sample, const TakeHit& take) const {
  const Hemisphere& hemisphere = pass_.hemisphereOf(sample, direct_.looks.double_rays[sample] != 0);
  const StoredHits hits(direct_.hits, pass_, sample, sample + 1);
  const glm::mat3 frame(localFrame(glm::normalize(glm::dvec3(scene_.samples.normals[sample]))));
  for (const GatherHit& hit : hits.of(sample))
    take(hit, static_cast<float>(hemisphere.weight(hit.ray)),
         exit_.albedo(hit, -(frame * hemisphere.direction(hit.ray))));
}

void BounceGather::range(const Bounce& bounce, std::size_t begin, std::size_t end, TransferField& now,
                         TransferField& mapped) const {
  std::vector<GatherHit> thinned;
  const StoredHits hits(direct_.hits, pass_, begin, end);
  const std::size_t first_mapped = scene_.samples.normal_mapped.begin;
  for (std::size_t s = begin; s < end; ++s) {
    const Hemisphere& hemisphere = pass_.hemisphereOf(s, direct_.looks.double_rays[s] != 0);
    const ExitToSample exit(bounce, hemisphere.table(), scene_.samples.normals[s], s);
    Received received{hits.of(s), 1.0f, hemisphere, exit};
    if (bounce.thinly) received.scale = thinHits(bounce.number, hemisphere, received.hits, thinned);
    if (s < first_mapped)
      exit.addAll(
          received.hits,
          [&](std::uint32_t ray) { return received.scale * static_cast<float>(hemisphere.weight(ray)); },
          now.at(s));
    else
      gatherMapped(s, received, now.at(s), mapped.at(s - first_mapped));
  }
}

void BounceGather::gatherMapped(std::size_t sample, const Received& received, std::span<float> out,
                                std::span<float> mapped) const {
  const std::size_t stride = out.size();
  std::vector<float> exit(stride), local(kIncident * stride, 0.0f);
  for (const GatherHit& hit : received.hits) {
    std::fill(exit.begin(), exit.end(), 0.0f);
    received.exit.add(hit, received.scale, exit);
    const auto weight = static_cast<float>(received.hemisphere.weight(hit.ray));
    for (std::size_t i = 0; i < stride; ++i) out[i] += weight * exit[i];
    const auto& weights = received.hemisphere.incidentWeight(hit.ray);
    for (std::size_t j = 0; j < kIncident; ++j)
      for (std::size_t i = 0; i < stride; ++i) local[j * stride + i] += weights[j] * exit[i];
  }
  if (received.hits.empty()) return;
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
