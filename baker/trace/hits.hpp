// Keeps the hits of pass 0 for the passes that gather over them. They are sparse, since on open shapes few
// rays hit anything. Ranges of samples are kept up to a memory limit, whichever come first; the others are
// traced again when they are asked for and give the very same hits, so the result does not depend on which
// were kept.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/cache/key.hpp"

namespace lambent::baker {

inline constexpr std::size_t kSamplesPerRange = 256;
// Samples that a gathering pass works on at a time. Between glossy surfaces that see nothing but each other a
// sample takes 35 ms, and work that a killed bake had begun is lost.
inline constexpr std::size_t kSamplesGathered = 32;
static_assert(kSamplesPerRange % kSamplesGathered == 0);

struct GatherHit {
  std::uint32_t triangle = 0, ray = 0;
  std::uint16_t u = 0, v = 0;           // unorm16; barycentric weights of corners 1 and 2
  std::uint16_t albedo[3] = {0, 0, 0};  // unorm16; at the hit, times what panes before it pass of the light

  static std::uint16_t unorm(float value) {
    return static_cast<std::uint16_t>(std::clamp(value, 0.0f, 1.0f) * 65535.0f + 0.5f);
  }
  float uAt() const { return static_cast<float>(u) * (1.0f / 65535.0f); }
  float vAt() const { return static_cast<float>(v) * (1.0f / 65535.0f); }
  void setAlbedo(const glm::vec3& value) {
    for (int c = 0; c < 3; ++c) albedo[c] = unorm(value[c]);
  }
  glm::vec3 albedoAt() const { return glm::vec3(albedo[0], albedo[1], albedo[2]) * (1.0f / 65535.0f); }
};

// MirroredLight is what a ray of a sample found by way of mirrors (mirror_paths.hpp), beside diffuse
// surfaces.
struct MirroredLight {
  enum class From : std::uint8_t {
    Sky,             // distant light from `direction`
    Base,            // what the diffuse base of the mirror at `hit` sends in all directions
    Kernel,          // what the surface at `hit`, which is not diffuse, sends along `direction`
    LightsByKernel,  // that part of it that the group's own lights bring straight to `hit`
    Diffuse,         // what the diffuse surface at `hit` sends in all directions
    LightsByLayer,   // light that the group's own lights bring straight to the layer at `hit`, sent in all
                     // directions
  };
  GatherHit hit;  // where the path is; `albedo` is what it passes on of the light there
  glm::vec3 direction{0.0f};
  From from = From::Sky;

  glm::vec3 throughput() const { return hit.albedoAt(); }
};

// A sample that has at most this many hits keeps all of them.
inline constexpr std::size_t kHitsToThin = 64;
// The hits of every kThinned-th ray stand for all where the noise of fewer hits is not seen.
inline constexpr std::uint32_t kThinned = 4;

// Appends every n-th hit to `out`, the first of them being hits[first]. Rays lie along a Hilbert curve, so
// the kept ones are spread as evenly. Returns the factor on their weights that makes them stand for all, so
// that no light is lost or gained: a white furnace stays white.
template <typename WeightOfRay>
float keepEvery(std::uint32_t n, std::uint32_t first, std::span<const GatherHit> hits,
                const WeightOfRay& weight_of, std::vector<GatherHit>& out) {
  const bool all_kept = n <= 1 || hits.size() <= kHitsToThin;
  if (all_kept) {
    out.insert(out.end(), hits.begin(), hits.end());
    return 1.0f;
  }
  double all = 0.0, kept = 0.0;
  for (std::size_t h = 0; h < hits.size(); ++h) {
    const double weight = weight_of(hits[h].ray);
    all += weight;
    if (h % n != first) continue;
    kept += weight;
    out.push_back(hits[h]);
  }
  return kept > 0.0 ? static_cast<float>(all / kept) : 1.0f;
}

// RangeHits are the hits of one range of samples.
struct RangeHits {
  std::vector<std::uint32_t> offsets;  // index of each sample's first hit, then the number of hits
  std::vector<GatherHit> hits;
  // Factor on the weights of each sample's hits, and of what they found by way of mirrors (keepEvery). It is
  // empty if all hits were kept.
  std::vector<float> scales;
  // The same for light that came by way of mirrors; both are empty if there is none.
  std::vector<std::uint32_t> mirrored_offsets;
  std::vector<MirroredLight> mirrored;
  bool kept = false;

  // Starts the next sample: hits that are appended from here on are its own. The last call ends the range.
  void next() { offsets.push_back(static_cast<std::uint32_t>(hits.size())); }
  std::size_t bytes() const {
    return hits.size() * sizeof(GatherHit) + mirrored.size() * sizeof(MirroredLight);
  }
  // Returns the hits of the sample at this index in the range.
  std::span<const GatherHit> of(std::size_t sample) const {
    return std::span(hits).subspan(offsets[sample], offsets[sample + 1] - offsets[sample]);
  }
  float scaleOf(std::size_t sample) const { return scales.empty() ? 1.0f : scales[sample]; }
  std::span<const MirroredLight> mirroredOf(std::size_t sample) const {
    if (mirrored.empty()) return {};
    return std::span(mirrored).subspan(mirrored_offsets[sample],
                                       mirrored_offsets[sample + 1] - mirrored_offsets[sample]);
  }
};

class HitStore {
 public:
  HitStore() = default;
  // Samples begin with `first`.
  HitStore(std::size_t samples, std::size_t limit_bytes, std::size_t first = 0)
      : ranges_((samples + kSamplesPerRange - 1) / kSamplesPerRange),
        first_(first),
        limit_bytes_(limit_bytes) {}
  HitStore(HitStore&& other) noexcept { *this = std::move(other); }
  HitStore& operator=(HitStore&& other) noexcept {
    ranges_ = std::move(other.ranges_);
    first_ = other.first_;
    limit_bytes_ = other.limit_bytes_;
    held_ = other.held_.load();
    return *this;
  }

  // Keeps the hits of a range if there is room. May be called from any thread, once for each range.
  void offer(std::size_t range, RangeHits&& hits) {
    const std::size_t bytes = hits.bytes();
    if (held_.fetch_add(bytes) + bytes > limit_bytes_) {
      held_.fetch_sub(bytes);
      return;
    }
    ranges_[range] = std::move(hits);
    ranges_[range].hits.shrink_to_fit();
    ranges_[range].mirrored.shrink_to_fit();
    ranges_[range].kept = true;
  }
  // Gives hits up, range by range from the end, until at most so many bytes are kept.
  void keepAtMost(std::size_t bytes) {
    for (auto range = ranges_.rbegin(); range != ranges_.rend() && held_ > bytes; ++range) {
      held_ -= range->bytes();
      *range = RangeHits();
    }
  }
  const RangeHits& range(std::size_t index) const { return ranges_[index]; }
  std::size_t first() const { return first_; }
  std::size_t bytes() const { return held_; }
  std::size_t bytesLeft() const { return limit_bytes_ - held_; }

 private:
  std::vector<RangeHits> ranges_;
  std::size_t first_ = 0, limit_bytes_ = 0;
  std::atomic<std::size_t> held_ = 0;
};

// StoredHits are the hits of samples [begin, end), which must lie in one range: those of the store, or traced
// again by the pass that found them.
class StoredHits {
 public:
  // Store and pass must outlive this.
  template <typename Pass>
  StoredHits(const HitStore& store, const Pass& pass, std::size_t begin, std::size_t end)
      : hits_(&store.range((begin - store.first()) / kSamplesPerRange)),
        first_(begin - (begin - store.first()) % kSamplesPerRange) {
    if (hits_->kept) return;
    pass.traceAgain(begin, end, again_);
    hits_ = &again_;
    first_ = begin;
  }
  StoredHits(const StoredHits&) = delete;
  StoredHits& operator=(const StoredHits&) = delete;

  std::span<const GatherHit> of(std::size_t sample) const { return hits_->of(sample - first_); }
  float scaleOf(std::size_t sample) const { return hits_->scaleOf(sample - first_); }
  std::span<const MirroredLight> mirroredOf(std::size_t sample) const {
    return hits_->mirroredOf(sample - first_);
  }

 private:
  const RangeHits* hits_;
  std::size_t first_;  // sample that hits_ starts with
  RangeHits again_;
};

// Packs the hits of a range of samples into bytes, without what the surfaces reflect: that is looked up
// again, so that traced results stay valid when colours change. What panes before a hit pass is kept.
// Neighbouring rays hit neighbouring triangles, so differences, stored as byte planes, leave little but the
// places on the triangles.

void writeHits(const RangeHits& hits, ByteWriter& out);
// `samples` is the number in the range, `triangles` that of the group. Returns false if the bytes are not
// such a range.
bool readHits(ByteReader& in, std::size_t samples, std::size_t triangles, RangeHits& hits);

}  // namespace lambent::baker
