// Solves linear systems x = G x + b for many right-hand sides at once, each column by itself, by restarted
// GMRES (Saad and Schultz 1986). Rows are unknowns, with kBlockColumns columns side by side. Sums run in a
// fixed order, so the result is the same for any number of threads.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "baker/cache/bytes.hpp"

namespace lambent::baker {

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

}  // namespace lambent::baker
