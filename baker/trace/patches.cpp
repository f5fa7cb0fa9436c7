#include "baker/trace/patches.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "baker/jobs/parallel.hpp"
#include "baker/jobs/stage.hpp"

namespace lambent::baker {

namespace {

// Samples of one level differ in brightness by a factor of 16 at most; those of the last are dark.
constexpr int kLevels = 8;
constexpr double kOctavesPerLevel = 4.0;

std::size_t levelOf(float brightness, float brightest) {
  if (!(brightness > 0.0f)) return kLevels - 1;
  const double octaves = std::log2(double{brightest} / double{brightness});
  return static_cast<std::size_t>(std::clamp(octaves / kOctavesPerLevel, 0.0, double{kLevels - 1}));
}

// Light of later bounces is taken to vary over a patch like that of the first, by at most this factor. With
// no profile at all Sponza lost 0.6 % of its light, with it 0.2 % are won.
constexpr double kMostProfile = 3.0;

// A turn of the normal by a right angle separates as much as this share of the group's diagonal.
constexpr float kNormalLength = 0.1f;

// Parts lists of samples in halves until there are as many lists as asked for.
class Splitter {
 public:
  Splitter(const SampleSet& samples, float diagonal)
      : samples_(samples), normal_scale_(kNormalLength * diagonal) {}

  template <typename Emit>
  void split(std::span<std::uint32_t> list, std::size_t parts, const Emit& emit) const {
    if (parts <= 1 || list.size() <= 1) return emit(list);
    const std::size_t axis = longestAxis(list), left = parts / 2;
    const std::size_t middle = std::clamp<std::size_t>(list.size() * left / parts, 1, list.size() - 1);
    std::nth_element(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(middle), list.end(),
                     [&](std::uint32_t a, std::uint32_t b) {
                       const float at_a = coordinate(a, axis), at_b = coordinate(b, axis);
                       return at_a != at_b ? at_a < at_b : a < b;
                     });
    split(list.first(middle), left, emit);
    split(list.subspan(middle), parts - left, emit);
  }

 private:
  float coordinate(std::uint32_t sample, std::size_t axis) const {
    return axis < 3 ? samples_.positions[sample][static_cast<int>(axis)]
                    : normal_scale_ * samples_.normals[sample][static_cast<int>(axis) - 3];
  }
  std::size_t longestAxis(std::span<const std::uint32_t> list) const {
    std::array<float, 6> extents{};
    for (std::size_t axis = 0; axis < extents.size(); ++axis) {
      float least = coordinate(list[0], axis), most = least;
      for (const std::uint32_t sample : list) {
        least = std::min(least, coordinate(sample, axis));
        most = std::max(most, coordinate(sample, axis));
      }
      extents[axis] = most - least;
    }
    return static_cast<std::size_t>(std::max_element(extents.begin(), extents.end()) - extents.begin());
  }

  const SampleSet& samples_;
  float normal_scale_;
};

// Samples that are not valid join a neighbour's patch, layer by layer; those without any neighbour stay in
// the first.
void joinNeighbours(std::span<const std::uint8_t> valid,
                    std::span<const std::pair<std::uint32_t, std::uint32_t>> edges,
                    std::vector<std::uint32_t>& of_sample) {
  std::vector<std::uint8_t> joined(valid.begin(), valid.end());
  for (bool any = true; any;) {
    any = false;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> joins;  // a sample, and the patch
    const auto join = [&](std::uint32_t sample, std::uint32_t from) {
      if (joined[sample] == 0 && joined[from] != 0) joins.emplace_back(sample, of_sample[from]);
    };
    for (const auto& [a, b] : edges) join(a, b), join(b, a);
    for (const auto& [sample, patch] : joins) {
      if (joined[sample] == 0 || patch < of_sample[sample]) of_sample[sample] = patch;
      joined[sample] = 1;
      any = true;
    }
  }
}

}  // namespace

Patches choosePatches(const SampleSet& samples, float diagonal, const PatchInputs& inputs,
                      std::span<const std::pair<std::uint32_t, std::uint32_t>> edges) {
  Patches patches;
  patches.of_sample.assign(samples.size(), 0);
  patches.profile.assign(samples.size(), 1.0f);
  patches.offsets.push_back(0);
  float brightest = 0.0f;
  for (const float value : inputs.brightness) brightest = std::max(brightest, value);
  std::array<std::vector<std::uint32_t>, 2 * kLevels> levels;  // glossy samples have their own
  std::size_t count = 0;
  for (std::uint32_t s = 0; s < samples.size(); ++s) {
    if (inputs.valid[s] == 0) continue;
    const std::size_t kind = s < samples.glossy.begin ? 0 : kLevels;
    levels[kind + levelOf(inputs.brightness[s], brightest)].push_back(s);
    ++count;
  }
  const Splitter splitter(samples, diagonal);
  const auto emit = [&](std::span<std::uint32_t> members) {
    std::sort(members.begin(), members.end());
    const auto patch = static_cast<std::uint32_t>(patches.size());
    double weight = 0.0;
    for (const std::uint32_t s : members) weight += double{inputs.weights[s]};
    double light = 0.0;
    const std::size_t first = patches.shares.size();
    for (const std::uint32_t s : members) {
      patches.of_sample[s] = patch;
      patches.samples.push_back(s);
      patches.shares.push_back(weight > 0.0 ? static_cast<float>(double{inputs.weights[s]} / weight)
                                            : 1.0f / static_cast<float>(members.size()));
      light += double{patches.shares.back()} * double{inputs.bounced[s]};
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < members.size() && light > 0.0; ++i) {
      const double profile =
          std::clamp(double{inputs.bounced[members[i]]} / light, 1.0 / kMostProfile, kMostProfile);
      patches.profile[members[i]] = static_cast<float>(profile);
      sum += double{patches.shares[first + i]} * profile;
    }
    if (sum > 0.0)
      for (const std::uint32_t s : members) patches.profile[s] /= static_cast<float>(sum);
    patches.offsets.push_back(static_cast<std::uint32_t>(patches.samples.size()));
  };
  for (std::vector<std::uint32_t>& level : levels) {
    if (level.empty()) continue;
    const std::size_t parts =
        count <= kMostPatches ? level.size() : std::max<std::size_t>(level.size() * kMostPatches / count, 1);
    splitter.split(level, parts, emit);
  }
  if (count < samples.size()) joinNeighbours(inputs.valid, edges, patches.of_sample);
  return patches;
}

namespace {

constexpr std::size_t kPatchesPerRange = 8;

std::array<float, 3> cornerWeights(const GatherHit& hit) {
  return {1.0f - hit.uAt() - hit.vAt(), hit.uAt(), hit.vAt()};
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
    float* const links = links_.data() + patch * channels_ * count;
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
