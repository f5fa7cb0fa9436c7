#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

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

// LeastSquares is the least-squares problem of one column, solved by Givens rotations.
struct LeastSquares {
  std::vector<std::vector<double>> h;  // columns of the triangular matrix
  std::vector<double> cosine, sine, g;

  explicit LeastSquares(double length = 0.0) : g(1, length) {}
  void add(std::vector<double> column) {
    const std::size_t j = h.size();
    for (std::size_t i = 0; i < j; ++i) {
      const double a = column[i], b = column[i + 1];
      column[i] = cosine[i] * a + sine[i] * b;
      column[i + 1] = cosine[i] * b - sine[i] * a;
    }
    const double r = std::hypot(column[j], column[j + 1]);
    cosine.push_back(r > 0.0 ? column[j] / r : 1.0);
    sine.push_back(r > 0.0 ? column[j + 1] / r : 0.0);
    column[j] = r;
    g.push_back(-sine[j] * g[j]);
    g[j] *= cosine[j];
    h.push_back(std::move(column));
  }

  std::vector<double> solve() const {
    std::vector<double> y(h.size(), 0.0);
    for (std::size_t i = h.size(); i-- > 0;) {
      double sum = g[i];
      for (std::size_t j = i + 1; j < h.size(); ++j) sum -= h[j][i] * y[j];
      y[i] = h[i][i] > 1e-30 ? sum / h[i][i] : 0.0;
    }
    return y;
  }
};

}  // namespace

GmresResult solveGmres(std::span<const float> b, std::span<float> x,
                       const std::function<bool(std::span<const float>, std::span<float>)>& apply,
                       const GmresSettings& settings) {
  const std::size_t rows = b.size() / kBlockColumns;
  const double wanted = lengthOf(dots(b, b));
  if (wanted == 0.0) {
    std::fill(x.begin(), x.end(), 0.0f);
    return {};
  }
  GmresResult result;
  const auto applied = [&](std::span<const float> from, std::span<float> to) {
    ++result.iterations;
    result.stopped = !apply(from, to);
    return !result.stopped;
  };
  double before = 0.0;  // residual of the previous round; 0: none
  Vector image(b.size());
  while (true) {
    // The residual is r = b - (x - G x).
    if (!applied(x, image)) return result;
    std::vector<Vector> basis(1, Vector(b.size()));
    overRows(rows, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin * kBlockColumns; i < end * kBlockColumns; ++i)
        basis[0][i] = b[i] - x[i] + image[i];
    });
    const ColumnSums length = normalize(basis[0]);
    ColumnSums squares;
    std::array<LeastSquares, kBlockColumns> small;
    for (std::size_t c = 0; c < kBlockColumns; ++c)
      small[c] = LeastSquares(length[c]), squares[c] = length[c] * length[c];
    result.residual = lengthOf(squares) / wanted;
    // Rounding sets a floor: a residual that a whole round hardly improves will not get better.
    const bool stuck = before > 0.0 && result.residual > 0.7 * before && result.residual < 1e-3;
    if (result.residual <= settings.tolerance || result.iterations >= settings.most_iterations || stuck)
      return result;
    before = result.residual;

    for (int j = 0; j < settings.restart && result.iterations < settings.most_iterations; ++j) {
      const Vector& v = basis.back();
      if (!applied(v, image)) return result;
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
        small[c].add(std::move(column[c]));
        left += small[c].g.back() * small[c].g.back();
      }
      basis.push_back(std::move(next));
      if (std::sqrt(left) <= settings.tolerance * wanted) break;
    }
    std::array<std::vector<double>, kBlockColumns> y;
    for (std::size_t c = 0; c < kBlockColumns; ++c) y[c] = small[c].solve();
    for (std::size_t j = 0; j < y[0].size(); ++j) {
      ColumnSums factor;
      for (std::size_t c = 0; c < kBlockColumns; ++c) factor[c] = y[c][j];
      addColumns(x, basis[j], factor);
    }
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
