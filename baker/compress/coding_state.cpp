#include "baker/compress/coding_state.hpp"

#include <algorithm>

#include "baker/compress/kept_transfer.hpp"
#include "baker/jobs/kept_value.hpp"

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

void write(const CodingState& state, ByteWriter& out) {
  out.add(state.step), write(state.basis, out), out.add(state.reachable), out.add(state.budget);
  out.add(state.most_clusters), out.add(state.tried), out.add(state.fewest_bytes);
  write(state.best, out), write(state.rounds, out), out.add(state.attempt), out.add(state.quantum);
  write(state.coded, out);
}

bool read(ByteReader& in, CodingState& state) {
  return in.read(state.step) && read(in, state.basis) && in.read(state.reachable) && in.read(state.budget) &&
         in.read(state.most_clusters) && in.read(state.tried) && in.read(state.fewest_bytes) &&
         read(in, state.best) && read(in, state.rounds) && in.read(state.attempt) && in.read(state.quantum) &&
         read(in, state.coded);
}

bool CodingCheckpoint::restore(std::size_t count, CodingState& state) const {
  CodingState found;
  if (!findKept(context_, found) || found.best.ids.size() > count || found.rounds.ids.size() > count)
    return false;
  state = std::move(found);
  return true;
}

void CodingCheckpoint::save(const CodingState& state, bool stopped) const {
  if (!context_.keeps() || !(stopped || context_.checkpointDue())) return;
  keepValue(context_, state);
  context_.cache->checkpointed();
}

void CodingCheckpoint::drop() const {
  dropValue(context_);
}

}  // namespace lambent::baker
