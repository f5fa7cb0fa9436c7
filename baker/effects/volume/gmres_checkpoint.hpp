// Where a run of the solver stands (gmres.cpp), for a later run to go on from: kept when a checkpoint is due
// and when it is stopped. The vectors of a round are kept one by one as they come, the rest with each
// checkpoint.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "baker/effects/volume/scatter_rows.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

// The least-squares problem of one column, by Givens rotations.
struct LeastSquares {
  std::vector<std::vector<double>> h;  // columns of the triangle
  std::vector<double> cosine, sine, g;

  void begin(double length);
  void add(std::vector<double> column);
  std::vector<double> solve() const;
};

struct GmresState {
  int round = 0, iterations = 0;
  double residual = 0.0;                  // of x
  double before = 0.0;                    // of the round before; 0: none
  std::vector<std::vector<float>> basis;  // of this round; empty before it
  std::array<LeastSquares, kBlockColumns> small;
};

class GmresCheckpoints {
 public:
  GmresCheckpoints(const BakeContext& context, int restart) : context_(context), restart_(restart) {}

  // False, and nothing changed, where nothing whole is kept.
  bool restore(GmresState& state, std::span<float> x) const;
  void save(const GmresState& state, std::span<const float> x);
  void saveIfDue(const GmresState& state, std::span<const float> x);
  // The result is there: checkpoints go.
  void drop(int last_round) const;

 private:
  BakeContext ofVector(int round, std::size_t index) const { return context_.part("vector", round, index); }

  BakeContext context_;
  int restart_;
  int saved_round_ = -1;
  std::size_t saved_ = 0;  // vectors of that round
};

}  // namespace lambent::baker
