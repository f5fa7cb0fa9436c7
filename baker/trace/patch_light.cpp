#include "baker/trace/patch_light.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>

#include "baker/jobs/parallel.hpp"
#include "baker/jobs/stage.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kPatchesPerRange = 8;

std::array<float, 3> cornerWeights(const GatherHit& hit) {
  const float u = static_cast<float>(hit.u) * (1.0f / 65535.0f),
              v = static_cast<float>(hit.v) * (1.0f / 65535.0f);
  return {1.0f - u - v, u, v};
}

}  // namespace

std::optional<std::vector<float>> samplesMet(std::span<const float> areas, const SamplesOfHit& corners,
                                             const VisitHits& visit, const BakeContext& context) {
  // Sums in whole numbers do not depend on their order. All areas together are 2^52 of them.
  double area = 0.0;
  for (const float one : areas) area += double{one};
  const double scale = area > 0.0 ? 0x1p52 / area : 0.0;
  std::vector<std::atomic<std::uint64_t>> sums(areas.size());
  const bool done =
      parallelRanges(areas.size(), kSamplesPerRange, context.stop, [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s)
          visit(s, [&](const GatherHit& hit, float weight, const glm::vec3& albedo) {
            const std::array<float, 3> parts = cornerWeights(hit);
            const double sent = scale * double{areas[s] * weight * (albedo.x + albedo.y + albedo.z)} / 3.0;
            const glm::uvec3 met = corners(hit);
            for (std::size_t c = 0; c < 3; ++c)
              sums[met[static_cast<int>(c)]].fetch_add(
                  static_cast<std::uint64_t>(std::max(sent * double{parts[c]}, 0.0)),
                  std::memory_order_relaxed);
          });
      });
  if (!done) return std::nullopt;
  return std::vector<float>(sums.begin(), sums.end());
}

bool PatchTransport::build(const VisitHits& visit, const BakeContext& context) {
  const std::size_t count = patches_.size();
  links_.assign(count * channels_ * count, 0.0f);
  const auto gather = [&](std::size_t patch) {
    const std::span<float> links = row(patch);
    for (std::uint32_t i = patches_.offsets[patch]; i < patches_.offsets[patch + 1]; ++i) {
      const float share = patches_.shares[i];
      visit(patches_.samples[i], [&](const GatherHit& hit, float weight, const glm::vec3& albedo) {
        const glm::uvec3 corners = corners_(hit);
        const std::array<float, 3> weights = cornerWeights(hit);
        for (int corner = 0; corner < 3; ++corner) {
          const std::uint32_t sender = patches_.of_sample[corners[corner]];
          const float arriving =
              share * weight * weights[static_cast<std::size_t>(corner)] * patches_.profile[corners[corner]];
          for (std::size_t c = 0; c < channels_; ++c)
            links[c * count + sender] += arriving * albedo[static_cast<int>(c)];
        }
      });
    }
  };
  return runStage({.name = "bounce between patches",
                   .unit = "patches",
                   .count = count,
                   .grain = kPatchesPerRange,
                   .writes = {rowsOf(links_, channels_ * count)},
                   .compute =
                       [&](std::size_t begin, std::size_t end) {
                         for (std::size_t patch = begin; patch < end && !context.stopped(); ++patch)
                           gather(patch);
                       }},
                  context.keyed({}))
      .has_value();
}

TransferField PatchTransport::meansOf(const TransferField& samples) const {
  TransferField means = samples.zeros(patches_.size());
  for (std::size_t patch = 0; patch < patches_.size(); ++patch) {
    const std::span<float> mean = means.at(patch);
    for (std::uint32_t i = patches_.offsets[patch]; i < patches_.offsets[patch + 1]; ++i) {
      const std::span<const float> vector = samples.at(patches_.samples[i]);
      for (std::size_t k = 0; k < mean.size(); ++k) mean[k] += patches_.shares[i] * vector[k];
    }
  }
  return means;
}

TransferField PatchTransport::bounce(const TransferField& before) const {
  TransferField after = before.zeros(before.size());
  const std::size_t count = patches_.size(), columns = before.columns, stride = before.vectorSize();
  parallelRanges(count, kPatchesPerRange, {}, [&](std::size_t begin, std::size_t end) {
    for (std::size_t patch = begin; patch < end; ++patch)
      for (std::size_t c = 0; c < channels_; ++c) {
        const float* const links = links_.data() + (patch * channels_ + c) * count;
        float* const out = after.at(patch).data() + c * columns;
        for (std::size_t sender = 0; sender < count; ++sender) {
          const float link = links[sender];
          if (link == 0.0f) continue;
          const float* const in = before.vectors.data() + sender * stride + c * columns;
          for (std::size_t i = 0; i < columns; ++i) out[i] += link * in[i];
        }
      }
  });
  return after;
}

}  // namespace lambent::baker
