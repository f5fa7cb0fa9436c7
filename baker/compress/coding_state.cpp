#include "baker/compress/coding_state.hpp"

#include <algorithm>

#include "baker/compress/kept_transfer.hpp"

namespace lambent::baker {

namespace {

void write(const Rounds& rounds, ByteWriter& out) {
  out.addList(rounds.ids);
  out.add(rounds.next);
}

bool read(ByteReader& in, Rounds& rounds) {
  return in.readList(rounds.ids) && in.read(rounds.next);
}

}  // namespace

bool CodingCheckpoint::restore(std::size_t count, CodingState& state) const {
  if (!keep_.cache) return false;
  const auto bytes = keep_.cache->find(keep_.key);
  if (!bytes) return false;
  ByteReader in(*bytes);
  CodingState found;
  if (!in.read(found.step) || !read(in, found.basis) || !in.read(found.reachable) || !in.read(found.budget) ||
      !in.read(found.most_clusters) || !in.read(found.tried) || !in.read(found.fewest_bytes) ||
      !read(in, found.best) || !read(in, found.rounds) || !in.read(found.attempt) ||
      !in.read(found.quantum) || !read(in, found.coded) || !in.atEnd() || found.best.ids.size() > count ||
      found.rounds.ids.size() > count)
    return false;
  state = std::move(found);
  return true;
}

void CodingCheckpoint::save(const CodingState& state, bool stopped) const {
  if (!keep_.cache || !(stopped || keep_.cache->checkpointDue())) return;
  ByteWriter out;
  out.add(state.step), write(state.basis, out), out.add(state.reachable), out.add(state.budget);
  out.add(state.most_clusters), out.add(state.tried), out.add(state.fewest_bytes);
  write(state.best, out), write(state.rounds, out), out.add(state.attempt), out.add(state.quantum);
  write(state.coded, out);
  keep_.cache->put(keep_.key, out.bytes());
  keep_.cache->checkpointed();
}

void CodingCheckpoint::drop() const {
  if (keep_.cache) keep_.cache->drop(keep_.key);
}

}  // namespace lambent::baker
