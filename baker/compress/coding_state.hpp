// How far the coding of one transfer has come (cpca.cpp), for a later run to go on from: kept under one key
// when a checkpoint is due, and when it is stopped. Of clusters only who belongs where: what they are follows
// from that.
#pragma once

#include <cstdint>
#include <limits>

#include "baker/cache/cached_ranges.hpp"
#include "baker/compress/cpca.hpp"
#include "baker/compress/cpca_clusters.hpp"

namespace lambent::baker {

// Iterative PCA between two rounds.
struct Rounds {
  ClusterIds ids;  // empty before the first
  std::uint32_t next = 0;
};

struct CodingState {
  enum class Step : std::uint32_t {
    Basis,   // nothing is there
    Search,  // for the number of clusters
    Refine,  // over all samples
    Fit,     // to the bound
  };
  Step step = Step::Basis;
  bundle::SharedCodebook basis;
  double reachable = 0.0, budget = 0.0;  // mean square errors
  // Of the search: clusters that there may be, counts that were tried, the best of them, and the one at work.
  std::uint32_t most_clusters = std::numeric_limits<std::uint32_t>::max(), tried = 0;
  double fewest_bytes = std::numeric_limits<double>::infinity();
  Rounds best;
  Rounds rounds;  // of the search, then of all samples
  std::uint32_t attempt = 0;
  double quantum = 0.0;  // the step of weights of that attempt
  CodedTransfer coded;   // best so far
};

class CodingCheckpoint {
 public:
  // keep: of all that the coding depends on.
  explicit CodingCheckpoint(const Keep& keep) : keep_(keep.part("state")) {}

  // False, and nothing changed, where nothing whole is kept. count: samples of the transfer.
  bool restore(std::size_t count, CodingState& state) const;
  // After a step of the work: if it is time, or the work ends here.
  void save(const CodingState& state, bool stopped) const;
  // The result is kept.
  void drop() const;

 private:
  Keep keep_;
};

}  // namespace lambent::baker
