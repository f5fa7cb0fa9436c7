#include "baker/effects/volume/gmres_checkpoint.hpp"

#include <cmath>

#include "baker/jobs/kept_value.hpp"

namespace lambent::baker {

void LeastSquares::begin(double length) {
  h.clear(), cosine.clear(), sine.clear();
  g.assign(1, length);
}

void LeastSquares::add(std::vector<double> column) {
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

std::vector<double> LeastSquares::solve() const {
  std::vector<double> y(h.size(), 0.0);
  for (std::size_t i = h.size(); i-- > 0;) {
    double sum = g[i];
    for (std::size_t j = i + 1; j < h.size(); ++j) sum -= h[j][i] * y[j];
    y[i] = h[i][i] > 1e-30 ? sum / h[i][i] : 0.0;
  }
  return y;
}

bool GmresCheckpoints::restore(GmresState& state, std::span<float> x) const {
  if (!context_.keeps()) return false;
  const auto bytes = context_.cache->find(context_.part("state").key);
  if (!bytes) return false;
  ByteReader in(*bytes);
  GmresState found;
  std::vector<float> x_found;
  std::uint64_t vectors = 0;
  if (!in.read(found.round) || !in.read(found.iterations) || !in.read(found.residual) ||
      !in.read(found.before) || !in.readList(x_found) || x_found.size() != x.size() || !in.read(vectors) ||
      vectors > static_cast<std::uint64_t>(restart_) + 1)
    return false;
  const std::uint64_t columns = vectors > 0 ? vectors - 1 : 0;
  for (LeastSquares& small : found.small) {
    if (!in.readList(small.cosine) || !in.readList(small.sine) || !in.readList(small.g) ||
        small.cosine.size() != columns || small.sine.size() != columns ||
        small.g.size() != (vectors > 0 ? columns + 1 : 0))
      return false;
    for (std::uint64_t j = 0; j < columns; ++j)
      if (!in.readList(small.h.emplace_back()) || small.h.back().size() <= j) return false;
  }
  if (!in.atEnd()) return false;
  for (std::size_t j = 0; j < vectors; ++j) {
    const auto kept = context_.cache->find(ofVector(found.round, j).key);
    if (!kept) return false;
    ByteReader vector(*kept);
    if (!vector.readList(found.basis.emplace_back()) || !vector.atEnd() ||
        found.basis.back().size() != x.size())
      return false;
  }
  state = std::move(found);
  std::copy(x_found.begin(), x_found.end(), x.begin());
  return true;
}

void GmresCheckpoints::save(const GmresState& state, std::span<const float> x) {
  if (!context_.keeps()) return;
  if (saved_round_ != state.round) saved_round_ = state.round, saved_ = 0;
  for (; saved_ < state.basis.size(); ++saved_) {
    ByteWriter out;
    out.addList(state.basis[saved_]);
    context_.cache->put(ofVector(state.round, saved_).key, out.bytes());
  }
  ByteWriter out;
  out.add(state.round), out.add(state.iterations), out.add(state.residual), out.add(state.before);
  out.addList(x);
  out.add(std::uint64_t{state.basis.size()});
  for (const LeastSquares& small : state.small) {
    out.addList(small.cosine), out.addList(small.sine), out.addList(small.g);
    for (const std::vector<double>& column : small.h) out.addList(column);
  }
  context_.cache->put(context_.part("state").key, out.bytes());
  context_.cache->checkpointed();
}

void GmresCheckpoints::saveIfDue(const GmresState& state, std::span<const float> x) {
  if (context_.checkpointDue()) save(state, x);
}

void GmresCheckpoints::drop(int last_round) const {
  if (!context_.keeps()) return;
  dropValue(context_.part("state"));
  for (int round = 0; round <= last_round; ++round)
    for (int j = 0; j <= restart_; ++j) dropValue(ofVector(round, static_cast<std::size_t>(j)));
}

}  // namespace lambent::baker
