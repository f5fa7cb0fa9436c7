#include "baker/effects/diffuse/direct.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>

#include <glm/geometric.hpp>

#include "baker/effects/diffuse/fill.hpp"
#include "baker/effects/diffuse/projection_table.hpp"
#include "baker/transport/frame.hpp"
#include "baker/work/parallel.hpp"
#include "runtime/sh/rotation.hpp"

namespace lambent::baker {

namespace {

// An origin of which more first hits than this are backs lies inside a body or under something.
constexpr float kInsideShare = 0.5f;
constexpr std::size_t kGlanceRays = 16, kLookRays = 64;
constexpr std::size_t kSamplesPerRange = 256;

class DirectPass {
 public:
  DirectPass(const SampleSet& samples, const RayScene& rays, const DirectSettings& settings)
      : samples_(samples),
        rays_(rays),
        table_(cosineTable(settings.rays)),
        glance_(cosineTable(kGlanceRays)),
        look_(cosineTable(kLookRays)),
        projection_(table_, settings.order),
        order_(settings.order) {}

  // Samples [begin, end): transfer into `field`, and whether they can be trusted. Leaves the rest of them
  // when a stop is requested: a million rays a sample take seconds a range.
  std::uint64_t bake(std::size_t begin, std::size_t end, const std::stop_token& stop, TransferField& field,
                     std::vector<std::uint8_t>& valid) const {
    sh::Rotation group_from_local(glm::dmat3(1.0), order_);
    std::vector<std::uint16_t> blocked(table_.packets());
    std::vector<float> local(field.columns);
    std::vector<SampleOrigin> origins;
    std::uint64_t traced = 0;
    for (std::size_t s = begin; s < end && !stop.stop_requested(); ++s) {
      const glm::dmat3 frame = localFrame(glm::normalize(glm::dvec3(samples_.normals[s])));
      valid[s] = outsideOrigins(s, glm::mat3(frame), origins);
      if (origins.empty())
        std::fill(blocked.begin(), blocked.end(),
                  std::uint16_t{0});  // no face to stand on: nothing known blocks it
      else
        traced += rays_.trace(origins, glm::mat3(frame), table_, blocked);
      projection_.project(blocked, local);
      group_from_local.set(frame);
      group_from_local.apply(std::span<const float>(local), field.at(s));
    }
    return traced;
  }

 private:
  // The origins of a sample that do not lie inside something, weights made to sum to 1; all of them, and
  // false, if none is left.
  bool outsideOrigins(std::size_t sample, const glm::mat3& frame, std::vector<SampleOrigin>& origins) const {
    const auto all = samples_.originsOf(sample);
    origins.assign(all.begin(), all.end());
    if (all.empty()) return false;
    std::vector<float> shares(all.size());
    // Sixteen rays are enough to see that nothing is odd, which is nearly always so.
    rays_.backFaceShare(all, frame, glance_, shares);
    if (std::all_of(shares.begin(), shares.end(), [](float share) { return share == 0.0f; })) return true;
    rays_.backFaceShare(all, frame, look_, shares);
    origins.clear();
    float weight = 0.0f;
    for (std::size_t o = 0; o < all.size(); ++o) {
      if (shares[o] > kInsideShare) continue;
      origins.push_back(all[o]);
      weight += all[o].weight;
    }
    if (origins.empty()) {
      origins.assign(all.begin(), all.end());
      return false;
    }
    for (SampleOrigin& origin : origins) origin.weight /= weight;
    return true;
  }

  const SampleSet& samples_;
  const RayScene& rays_;
  DirectionTable table_, glance_, look_;
  ProjectionTable projection_;
  int order_;
};

}  // namespace

std::optional<TransferField> bakeDirect(const GroupGeometry& geometry, const SampleSet& samples,
                                        const RayScene& rays, const DirectSettings& settings,
                                        Progress& progress, std::stop_token stop) {
  TransferField field;
  field.order = settings.order;
  field.columns = static_cast<std::uint32_t>(sh::coefficientCount(settings.order));
  field.vectors.resize(samples.size() * field.vectorSize());
  std::vector<std::uint8_t> valid(samples.size(), 0);
  std::atomic<std::uint64_t> traced = 0;
  const DirectPass pass(samples, rays, settings);
  const bool finished =
      parallelRanges(samples.size(), kSamplesPerRange, stop, [&](std::size_t begin, std::size_t end) {
        traced += pass.bake(begin, end, stop, field, valid);
        progress.add(end - begin);
      });
  if (!finished) return std::nullopt;
  field.rays = traced;
  field.filled_samples = fillFromNeighbours(sampleEdges(geometry, samples), valid, field);
  return field;
}

}  // namespace lambent::baker
