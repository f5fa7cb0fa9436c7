// What passes of bounces over diffuse and over other surfaces have in common: the radiance that leaves what
// rays met, and how late passes are thinned.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "baker/jobs/bake_context.hpp"
#include "baker/trace/hits.hpp"
#include "baker/trace/patch_light.hpp"
#include "baker/trace/transfer_field.hpp"
#include "baker/transport/direction_table.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

class ExitRadiance;

// One pass of bounces, for all that gather in it.
struct Bounce {
  int number;   // from 1 on
  bool thinly;  // late passes are thinned
  const ExitRadiance& exit;
  const TransferField& before;  // plain transfer of all samples, of what this pass passes on
  // What of it samples of other surfaces than diffuse ones have from patches alone; null: nothing. They
  // reflect it alike in all directions.
  const PatchRadiance* of_patches = nullptr;
  // How much more light this pass passes on than the one before brought.
  double growth = 1.0;
};

// Surfaces that reflect by another law than Lambert's, with samples of their own (SampleSet::glossy
// on): they take part in every pass, as senders and as receivers.
class BouncePartner {
 public:
  virtual ~BouncePartner() = default;
  // As ExitRadiance::add, of a hit on a triangle of its own; `corners` are the triangle's samples.
  virtual void addExit(const GatherHit& hit, const glm::uvec3& corners, const glm::vec3& to, float chance,
                       float weight, std::span<float> sum) const = 0;
  // Returns how much of uniform light the point that was met reflects towards `to`, for each channel.
  virtual glm::vec3 albedo(const GatherHit& hit, const glm::vec3& to) const = 0;
  // Calls take with the hits of a sample of its own, and the direction from each towards the sample.
  using TakeGlossyHit = std::function<void(const GatherHit& hit, float weight, const glm::vec3& to)>;
  virtual void visitHits(std::size_t sample, const TakeGlossyHit& take) const = 0;
  // Gathers one pass over its samples. `now` is the plain transfer of all samples, and gets what follows at
  // its own. The key of the context is that of this pass. Returns false if stopped.
  virtual bool gather(const Bounce& bounce, TransferField& now, const BakeContext& context) = 0;
  // Makes what was gathered last the state of the pass before.
  virtual void advance() = 0;
  // RMS of what was gathered last (at first: of pass 0), for each source of light: the environment, then each
  // light.
  virtual std::vector<double> energies() const = 0;
};

// What leaves the points that rays met, after the pass before.
class ExitRadiance {
 public:
  // partner: null where all is diffuse.
  ExitRadiance(const GroupGeometry& geometry, const SampleSet& samples, const BouncePartner* partner);

  bool isDiffuse(const GatherHit& hit) const { return triangle_samples_[hit.triangle].x < glossy_begin_; }
  bool anyGlossy() const { return partner_ != nullptr; }
  // weight * albedo * interpolated transfer, added to `sum`, laid out as a sample of `before`.
  void addDiffuse(const GatherHit& hit, float weight, const TransferField& before,
                  std::span<float> sum) const;
  // What leaves a hit that is not diffuse towards `to` (unit, group frame, away from the surface). chance:
  // below 0, what is known at the triangle's corners is interpolated; from [0, 1), it picks one corner for
  // all three, as often as its weight says: the same in the mean for a third of the reading (thinned passes).
  void addGlossy(const GatherHit& hit, const glm::vec3& to, float chance, float weight,
                 std::span<float> sum) const;
  // What leaves a hit that is not diffuse of light that patches brought.
  void addPatches(const GatherHit& hit, const glm::vec3& to, float weight, const PatchRadiance& patches,
                  std::span<float> sum) const;
  // Returns how much of the light at a hit leaves it towards `to`.
  glm::vec3 albedo(const GatherHit& hit, const glm::vec3& to) const;
  std::span<const glm::uvec3> triangleSamples() const { return triangle_samples_; }

 private:
  std::vector<glm::uvec3> triangle_samples_;
  std::size_t glossy_begin_;
  const BouncePartner* partner_;
};

// The same as one sample receives it along its rays.
class ExitToSample {
 public:
  // table: of the sample's rays, z along its normal. Bounce and table outlive it.
  ExitToSample(const Bounce& bounce, const DirectionTable& table, const glm::vec3& normal,
               std::size_t sample);

  void add(const GatherHit& hit, float weight, std::span<float> sum) const {
    if (bounce_.exit.isDiffuse(hit))
      bounce_.exit.addDiffuse(hit, weight, bounce_.before, sum);
    else
      addGlossy(hit, weight, sum);
  }

 private:
  void addGlossy(const GatherHit& hit, float weight, std::span<float> sum) const;

  const Bounce& bounce_;
  const DirectionTable& table_;
  glm::mat3 frame_{1.0f};
  std::uint32_t seed_ = 0;
};

// Where a sample has more hits than this, thinning leaves those of every kThinned-th ray.
inline constexpr std::size_t kHitsToThin = 64;
inline constexpr std::uint32_t kThinned = 4;

// The hits of every kThinned-th ray (rays lie along a Hilbert curve, so these are as evenly spread), others
// in each bounce: `hits` becomes those, kept in `out`. Returns what their weights must be multiplied with to
// stand for all, so that no light is lost or won: a white furnace stays white.
template <typename Rays>
float thinHits(int bounce, const Rays& rays, std::span<const GatherHit>& hits, std::vector<GatherHit>& out) {
  if (hits.size() <= kHitsToThin) return 1.0f;
  out.clear();
  double all = 0.0, kept = 0.0;
  for (const GatherHit& hit : hits) {
    const double weight = rays.weight(hit.ray);
    all += weight;
    if (hit.ray % kThinned != static_cast<std::uint32_t>(bounce) % kThinned) continue;
    kept += weight;
    out.push_back(hit);
  }
  if (out.empty()) return 1.0f;
  hits = out;
  return static_cast<float>(all / kept);
}

}  // namespace lambent::baker
