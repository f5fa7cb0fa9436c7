// Computes one more scattering in a medium with an isotropic phase function: the mean radiance that arrives
// at each sample after one scattering is a weighted sum of what arrived at all samples before it,
//   T^k(p) = sum_q w k_pq T^{k-1}(q),
// where w is the albedo and k_pq comes from rays of p that pass near q:
//   T^k(p) = (1/4pi) int ds int sigma(x_t) tau(p, x_t) w T^{k-1}(x_t) dt      (literature 1.8)
// with T linear between the samples. A stretch of a ray of optical depth e scatters tau (1 - exp(-e)), so
// that all stretches and the rest sum to one whatever their lengths: under uniform light a medium without
// absorption is invisible. Rays diverge, so far away they read coarser levels of the grid, with voxels as
// large as the distance between rays.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "baker/cache/key.hpp"
#include "baker/effects/volume/volume.hpp"
#include "baker/effects/volume/volume_rays.hpp"
#include "baker/jobs/stage.hpp"

namespace lambent::baker {

// Solves linear systems x = G x + b for many right-hand sides at once, each column by itself, by restarted
// GMRES (Saad and Schultz 1986). Rows are unknowns, with kBlockColumns columns side by side. Sums run in a
// fixed order, so the result is the same for any number of threads.

struct GmresSettings {
  double tolerance = 1e-5;    // on the residual relative to b, RMS over all columns
  int most_iterations = 400;  // applications of G
  int restart = 24;           // number of basis vectors that are kept
};

struct GmresResult {
  int iterations = 0;
  double residual = 0.0;  // relative, when the solver ended
  bool stopped = false;
};

// apply(x, y) computes y = G x and returns false if stopped. `x` is the first guess on entry and the solution
// on return.
GmresResult solveGmres(std::span<const float> b, std::span<float> x,
                       const std::function<bool(std::span<const float>, std::span<float>)>& apply,
                       const GmresSettings& settings);

// A SolvedBlock is a block of columns with its solution. It is kept as soon as it is solved, since the next
// block may take long, too.
struct SolvedBlock {
  GmresResult result;
  std::span<float> x;
};
void write(const SolvedBlock& block, ByteWriter& out);
bool read(ByteReader& in, SolvedBlock& block);

// Columns are handled in blocks of this size, with those of a sample side by side: [sample][kBlockColumns].
inline constexpr std::size_t kBlockColumns = 32;

class ScatterRows {
  class Row;

 public:
  // `met` has for each sample the mean share of a ray that the medium takes before the ray reaches the
  // outside or a surface; rows sum to it. Rows are kept in at most `memory` bytes; those that do not fit are
  // traced again each time, with the same result. Returns nothing if stopped. Scene and table must outlive
  // this.
  static std::optional<ScatterRows> build(const VolumeScene& scene, const SphereTable& table,
                                          std::span<const double> met, std::uint64_t memory,
                                          const BakeContext& context);
  // Returns the number of samples whose rows were traced in this run; the others were found in the cache.
  std::size_t samplesTraced() const { return samples_traced_; }
  // Removes what build() kept.
  static void drop(const BakeContext& context, std::size_t samples) { dropStage(context, samples, kChunk); }

  std::size_t samples() const { return self_.size(); }
  // Returns k_pp of a sample, or the sum of its other weights.
  double self(std::size_t p) const { return self_[p]; }
  double others(std::size_t p) const { return others_[p]; }

  // Computes out_p = sum over q != p of k_pq x_q. `nodes` is [grid.nodes()][kBlockColumns], samples first;
  // its upper levels are filled in here. Returns false if stopped.
  bool apply(std::span<float> nodes, std::span<float> out, const std::stop_token& stop) const;

  // A Gather computes scattered light at places that are no samples. One object serves one thread.
  class Gather {
   public:
    explicit Gather(const ScatterRows& rows);
    ~Gather();
    // Computes one scattering: the light that comes along the table's rays, of which the medium takes the
    // share `met`. `nodes` holds blocks of columns as for apply(), with their upper levels filled in
    // (TransferGrid::raise); `out` has one block after the other.
    void look(const glm::vec3& place, const SphereTable& table, double met,
              std::span<const std::vector<float>> nodes, std::span<float> out);

   private:
    const ScatterRows& rows_;
    std::unique_ptr<Row> row_;
    std::vector<float> reach_;
  };

  std::uint64_t bytes() const { return chunks_.bytes(); }

 private:
  static constexpr std::size_t kChunk = 64;  // samples whose rows are stored together
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
  // Traces the rows of some samples. If `self` and `others` are not empty, stores their sums there.
  Chunk trace(std::size_t begin, std::size_t end, std::span<double> self, std::span<double> others) const;

  VolumeScene scene_;
  const SphereTable* table_;
  std::vector<double> met_, self_, others_;
  KeptChunks<Chunk> chunks_;
  RaySteps steps_;
  std::size_t samples_traced_ = 0;
};

}  // namespace lambent::baker
