#include "baker/effects/volume/gmres.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "baker/effects/volume/gmres_checkpoint.hpp"
#include "baker/effects/volume/scatter_rows.hpp"
#include "baker/jobs/parallel.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kRowsPerSum = 512;  // rows that are summed up together
using ColumnSums = std::array<double, kBlockColumns>;
using Vector = std::vector<float>;

template <typename Body>
void overRows(std::size_t rows, const Body& body) {
  parallelRanges(rows, kRowsPerSum, {}, [&](std::size_t begin, std::size_t end) { body(begin, end); });
}

ColumnSums dots(std::span<const float> a, std::span<const float> b) {
  const std::size_t rows = a.size() / kBlockColumns;
  std::vector<ColumnSums> partial((rows + kRowsPerSum - 1) / kRowsPerSum);
  overRows(rows, [&](std::size_t begin, std::size_t end) {
    ColumnSums sum{};
    for (std::size_t r = begin; r < end; ++r)
      for (std::size_t c = 0; c < kBlockColumns; ++c)
        sum[c] += double{a[r * kBlockColumns + c]} * double{b[r * kBlockColumns + c]};
    partial[begin / kRowsPerSum] = sum;
  });
  ColumnSums sum{};
  for (const ColumnSums& part : partial)
    for (std::size_t c = 0; c < kBlockColumns; ++c) sum[c] += part[c];
  return sum;
}

// Adds factor * from to `to`, column by column.
void addColumns(std::span<float> to, std::span<const float> from, const ColumnSums& factor) {
  std::array<float, kBlockColumns> f;
  for (std::size_t c = 0; c < kBlockColumns; ++c) f[c] = static_cast<float>(factor[c]);
  overRows(to.size() / kBlockColumns, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r)
      for (std::size_t c = 0; c < kBlockColumns; ++c)
        to[r * kBlockColumns + c] += f[c] * from[r * kBlockColumns + c];
  });
}

double lengthOf(const ColumnSums& squares) {
  double sum = 0.0;
  for (const double s : squares) sum += s;
  return std::sqrt(sum);
}

// Divides each column by its length; columns of length 0 become 0. Returns the lengths.
ColumnSums normalize(std::span<float> v) {
  ColumnSums length = dots(v, v), inverse;
  for (std::size_t c = 0; c < kBlockColumns; ++c) {
    length[c] = std::sqrt(length[c]);
    inverse[c] = length[c] > 1e-30 ? 1.0 / length[c] : 0.0;
  }
  std::array<float, kBlockColumns> f;
  for (std::size_t c = 0; c < kBlockColumns; ++c) f[c] = static_cast<float>(inverse[c]);
  overRows(v.size() / kBlockColumns, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r)
      for (std::size_t c = 0; c < kBlockColumns; ++c) v[r * kBlockColumns + c] *= f[c];
  });
  return length;
}

}  // namespace

GmresResult solveGmres(std::span<const float> b, std::span<float> x,
                       const std::function<bool(std::span<const float>, std::span<float>)>& apply,
                       const GmresSettings& settings, const BakeContext& context) {
  const std::size_t rows = b.size() / kBlockColumns;
  const double wanted = lengthOf(dots(b, b));
  if (wanted == 0.0) {
    std::fill(x.begin(), x.end(), 0.0f);
    return {};
  }
  GmresCheckpoints checkpoints(context, settings.restart);
  GmresState state;
  checkpoints.restore(state, x);
  std::vector<Vector>& basis = state.basis;
  const auto stopped = [&] {
    checkpoints.save(state, x);
    return GmresResult{state.iterations, state.residual, true};
  };
  Vector image(b.size());
  while (true) {
    if (basis.empty()) {
      // The residual is r = b - (x - G x).
      if (!apply(x, image)) return stopped();
      ++state.iterations;
      basis.assign(1, Vector(b.size()));
      overRows(rows, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin * kBlockColumns; i < end * kBlockColumns; ++i)
          basis[0][i] = b[i] - x[i] + image[i];
      });
      const ColumnSums length = normalize(basis[0]);
      ColumnSums squares;
      for (std::size_t c = 0; c < kBlockColumns; ++c)
        state.small[c].begin(length[c]), squares[c] = length[c] * length[c];
      state.residual = lengthOf(squares) / wanted;
      // Rounding sets a floor: a residual that a whole round hardly improves will not get better.
      const bool stuck = state.before > 0.0 && state.residual > 0.7 * state.before && state.residual < 1e-3;
      if (state.residual <= settings.tolerance || state.iterations >= settings.most_iterations || stuck) {
        checkpoints.drop(state.round);
        return {state.iterations, state.residual, false};
      }
      state.before = state.residual;
    }

    for (auto j = static_cast<int>(basis.size()) - 1;
         j < settings.restart && state.iterations < settings.most_iterations; ++j) {
      const Vector& v = basis.back();
      if (!apply(v, image)) return stopped();
      ++state.iterations;
      Vector next(b.size());
      overRows(rows, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin * kBlockColumns; i < end * kBlockColumns; ++i) next[i] = v[i] - image[i];
      });
      std::array<std::vector<double>, kBlockColumns> column;
      for (const Vector& earlier : basis) {
        ColumnSums h = dots(next, earlier);
        for (std::size_t c = 0; c < kBlockColumns; ++c) column[c].push_back(h[c]), h[c] = -h[c];
        addColumns(next, earlier, h);
      }
      const ColumnSums last = normalize(next);
      double left = 0.0;
      for (std::size_t c = 0; c < kBlockColumns; ++c) {
        column[c].push_back(last[c]);
        state.small[c].add(std::move(column[c]));
        left += state.small[c].g.back() * state.small[c].g.back();
      }
      basis.push_back(std::move(next));
      if (std::sqrt(left) <= settings.tolerance * wanted) break;
      checkpoints.saveIfDue(state, x);
    }
    std::array<std::vector<double>, kBlockColumns> y;
    for (std::size_t c = 0; c < kBlockColumns; ++c) y[c] = state.small[c].solve();
    for (std::size_t j = 0; j < y[0].size(); ++j) {
      ColumnSums factor;
      for (std::size_t c = 0; c < kBlockColumns; ++c) factor[c] = y[c][j];
      addColumns(x, basis[j], factor);
    }
    basis.clear();
    state.small = {};
    ++state.round;
    checkpoints.saveIfDue(state, x);
  }
}

void write(const SolvedBlock& block, ByteWriter& out) {
  out.add(block.result.iterations), out.add(block.result.residual);
  out.addList(std::span<const float>(block.x));
}

bool read(ByteReader& in, SolvedBlock& block) {
  return in.read(block.result.iterations) && in.read(block.result.residual) && in.readInto(block.x);
}

}  // namespace lambent::baker
