// The state of the coding of one transfer (cpca.cpp), from which a later run can go on. It is kept under one
// key whenever a checkpoint is due and when the coding is stopped. Clusters are kept only as the cluster of
// each sample, because everything else follows from that.
#pragma once

#include <cstdint>
#include <limits>

#include "baker/cache/bytes.hpp"
#include "baker/compress/cpca.hpp"
#include "baker/compress/cpca_clusters.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

// Rounds is the state of iterative PCA between two rounds.
struct Rounds {
  ClusterIds ids;  // empty before the first round
  std::uint32_t next = 0;
};

struct CodingState {
  enum class Step : std::uint32_t {
    Basis,   // nothing is done yet
    Search,  // searches for the number of clusters
    Refine,  // refines the clusters over all samples
    Fit,     // fits the quantization step to the bound
  };
  Step step = Step::Basis;
  transfer::SharedCodebook basis;
  double reachable = 0.0, budget = 0.0;  // mean square errors
  // The search keeps the largest number of clusters allowed, how many counts were tried, the size and the
  // clusters of the best, and the clusters in progress.
  std::uint32_t most_clusters = std::numeric_limits<std::uint32_t>::max(), tried = 0;
  double fewest_bytes = std::numeric_limits<double>::infinity();
  Rounds best;
  Rounds rounds;  // of the search, then of all samples
  std::uint32_t attempt = 0;
  double quantum = 0.0;  // quantization step of the weights in that attempt
  CodedTransfer coded;   // the best so far
};

void write(const CodingState& state, ByteWriter& out);
bool read(ByteReader& in, CodingState& state);

class CodingCheckpoint {
 public:
  // The key of the context is that of all that the coding depends on.
  explicit CodingCheckpoint(const BakeContext& context) : context_(context.part("state")) {}

  // Returns false, and changes nothing, if no complete state is kept. `count` is the number of samples.
  bool restore(std::size_t count, CodingState& state) const;
  // Saves the state after a step of the work, if a checkpoint is due or the work was stopped.
  void save(const CodingState& state, bool stopped) const;
  // Removes the checkpoint, once the result itself is kept.
  void drop() const;

 private:
  BakeContext context_;
};

}  // namespace lambent::baker
