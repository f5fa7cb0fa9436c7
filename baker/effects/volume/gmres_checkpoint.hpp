// Keeps the state of a running solver (gmres.cpp), for a later run to continue from. It is written when a
// checkpoint is due and when the bake stops. Basis vectors of a round are written one by one as they come,
// all else with each checkpoint.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "baker/effects/volume/scatter_rows.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

// LeastSquares is the least-squares problem of one column, solved by Givens rotations.
struct LeastSquares {
  std::vector<std::vector<double>> h;  // columns of the triangular matrix
  std::vector<double> cosine, sine, g;

  void begin(double length);
  void add(std::vector<double> column);
  std::vector<double> solve() const;
};

struct GmresState {
  int round = 0, iterations = 0;
  double residual = 0.0;                  // of x
  double before = 0.0;                    // residual of the previous round; 0: none
  std::vector<std::vector<float>> basis;  // vectors of this round; empty before it begins
  std::array<LeastSquares, kBlockColumns> small;
};

class GmresCheckpoints {
 public:
  GmresCheckpoints(const BakeContext& context, int restart) : context_(context), restart_(restart) {}

  // Returns false and changes nothing if no complete state is kept.
  bool restore(GmresState& state, std::span<float> x) const;
  void save(const GmresState& state, std::span<const float> x);
  void saveIfDue(const GmresState& state, std::span<const float> x);
  // Removes the checkpoints, once the result is there.
  void drop(int last_round) const;

 private:
  BakeContext ofVector(int round, std::size_t index) const { return context_.part("vector", round, index); }

  BakeContext context_;
  int restart_;
  int saved_round_ = -1;
  std::size_t saved_ = 0;  // number of vectors of that round that are written
};

}  // namespace lambent::baker
