// Linear systems x = G x + b for many right sides at once, each column by itself, by restarted GMRES (Saad
// and Schultz 1986). Rows are unknowns, kBlockColumns columns side by side. Sums run in a fixed order: the
// same result for any number of threads. What long runs have found so far is kept where a cache is given, and
// a later run goes on from there with the same result.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "baker/cache/bytes.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

struct GmresSettings {
  double tolerance = 1e-5;    // of the residual, relative to b, RMS over all columns
  int most_iterations = 400;  // applications of G
  int restart = 24;           // vectors that are kept
};

struct GmresResult {
  int iterations = 0;
  double residual = 0.0;  // reached, relative
  bool stopped = false;
};

// apply(x, y): y = G x; false if stopped. x comes in as a first guess and goes out as the solution. The key
// of the context is that of b, G and the settings: checkpoints are kept under it.
GmresResult solveGmres(std::span<const float> b, std::span<float> x,
                       const std::function<bool(std::span<const float>, std::span<float>)>& apply,
                       const GmresSettings& settings, const BakeContext& context);

// A block of columns that is solved: kept as soon as it is there, since the next block may take long, too.
struct SolvedBlock {
  GmresResult result;
  std::span<float> x;
};
void write(const SolvedBlock& block, ByteWriter& out);
bool read(ByteReader& in, SolvedBlock& block);

}  // namespace lambent::baker
