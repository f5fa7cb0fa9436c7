// What the medium scatters once more: the mean radiance that arrives at each sample after one scattering is a
// weighted sum of what arrived at all samples before it,
//   T^k(p) = sum_q w k_pq T^{k-1}(q),
// w the albedo, k_pq from rays of p that pass near q:
//   T^k(p) = (1/4pi) int ds int sigma(x_t) tau(p, x_t) w T^{k-1}(x_t) dt      (literature 1.8)
// with T linear between the samples. A stretch of a ray of optical depth e scatters tau (1 - exp(-e)), so
// that all stretches and what gets out sum to one whatever their lengths: under uniform light a medium that
// absorbs nothing is not seen. Rays spread; what they meet far off is taken from coarser levels of the grid,
// of voxels as large as the distance between rays.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "baker/effects/volume/kept_chunks.hpp"
#include "baker/effects/volume/ray_steps.hpp"
#include "baker/effects/volume/sphere_table.hpp"
#include "baker/effects/volume/volume_scene.hpp"
#include "baker/jobs/stage.hpp"

namespace lambent::baker {

// Columns are handled in blocks of so many, each sample's side by side: [sample][kBlockColumns].
inline constexpr std::size_t kBlockColumns = 32;

class ScatterRows {
  class Row;

 public:
  // met: of each sample, the share of light going out (or coming in) that the medium meets before it gets out
  // or to a surface: rows sum to that. Rows are kept in at most `memory` bytes; those that do not fit are
  // traced again each time, with the same result. Nothing if stopped. All that is passed must outlive it.
  static std::optional<ScatterRows> build(const VolumeScene& scene, const SphereTable& table,
                                          std::span<const double> met, std::uint64_t memory,
                                          const BakeContext& context);
  // Samples of which rows were traced in this run; the others were kept.
  std::size_t samplesTraced() const { return samples_traced_; }
  // Removes what build() kept.
  static void drop(const BakeContext& context, std::size_t samples) { dropStage(context, samples, kChunk); }

  std::size_t samples() const { return self_.size(); }
  // Of a sample: k_pp, the sum of the others, what reaches the outside or a surface.
  double self(std::size_t p) const { return self_[p]; }
  double others(std::size_t p) const { return others_[p]; }

  // out_p = sum over q != p of k_pq x_q. nodes: [grid.nodes()][kBlockColumns], samples first; its upper
  // levels are filled here. False if stopped.
  bool apply(std::span<float> nodes, std::span<float> out, const std::stop_token& stop) const;

  // Scattered light at places that are no samples. One per thread.
  class Gather {
   public:
    explicit Gather(const ScatterRows& rows);
    ~Gather();
    // One scattering: what comes along the table's rays, which meet `met` of the medium. nodes: blocks of
    // columns as for apply(), their upper levels filled (TransferGrid::raise); out: a block after the other.
    void look(const glm::vec3& place, const SphereTable& table, double met,
              std::span<const std::vector<float>> nodes, std::span<float> out);

   private:
    const ScatterRows& rows_;
    std::unique_ptr<Row> row_;
    std::vector<float> reach_;
  };

  std::uint64_t bytes() const { return chunks_.bytes(); }

 private:
  static constexpr std::size_t kChunk = 64;  // samples whose rows lie together
  struct Chunk {
    std::vector<std::uint32_t> begins, nodes;
    std::vector<float> weights;
    std::uint64_t bytes() const { return 4 * (begins.size() + nodes.size() + weights.size()); }
    void shrink() { nodes.shrink_to_fit(), weights.shrink_to_fit(); }
    bool fits(std::size_t rows, std::size_t nodes_there) const;
    friend void write(const Chunk& chunk, ByteWriter& out) {
      out.addList(chunk.begins), out.addList(chunk.nodes), out.addList(chunk.weights);
    }
    friend bool read(ByteReader& in, Chunk& chunk) {
      return in.readList(chunk.begins) && in.readList(chunk.nodes) && in.readList(chunk.weights);
    }
  };

  ScatterRows(const VolumeScene& scene, const SphereTable& table, std::span<const double> met,
              std::uint64_t memory);
  void traceRow(const glm::vec3& origin, const SphereTable& table, std::vector<float>& reach, Row& row) const;
  // Adds the rows of some samples; self and others get their sums where given.
  Chunk trace(std::size_t begin, std::size_t end, std::span<double> self, std::span<double> others) const;

  VolumeScene scene_;
  const SphereTable* table_;
  std::vector<double> met_, self_, others_;
  KeptChunks<Chunk> chunks_;
  RaySteps steps_;
  std::size_t samples_traced_ = 0;
};

}  // namespace lambent::baker
