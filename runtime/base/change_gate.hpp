// Tells whether something must be made anew. It keeps the values that it was last made from, such as version
// counters, switches and sizes, without knowing what they mean.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

namespace lambent {

template <class... Values>
class ChangeGate {
 public:
  // Keeps the values and returns whether any of them differs from the last call. The first call returns true.
  bool renew(const Values&... values) {
    if (holds(values...)) return false;
    kept_.emplace(values...);
    return true;
  }
  // Returns whether the last call of renew() had these values.
  bool holds(const Values&... values) const { return kept_ == std::tuple<Values...>(values...); }
  // Returns whether renew() was called, at all or since forget().
  bool known() const { return kept_.has_value(); }
  // Makes the next call of renew() count as the first.
  void forget() { kept_.reset(); }

 private:
  std::optional<std::tuple<Values...>> kept_;
};

// Keeps one state per entry of a list that other code changes, at the same index. When entries come and go,
// their indices change; follow() then moves each state to the new index of its entry, which it finds by a key
// that the entry never changes. New entries get a default-constructed state, and states of removed entries
// are dropped, so no entry ever gets the state of another. Entries with equal keys keep their order.
template <class State>
class KeyedState {
 public:
  // Matches the states to `entries`. `key` returns an integer of at most 64 bits for an entry, or is a
  // pointer to such a member. Returns whether anything moved, came or went. The call is cheap if nothing did.
  template <class Entries, class Key>
  bool follow(const Entries& entries, Key key) {
    const auto key_of = [&](const auto& entry) -> std::uint64_t { return std::invoke(key, entry); };
    if (std::ranges::equal(entries, keys_, {}, key_of)) return false;
    std::multimap<std::uint64_t, std::size_t> places;
    for (std::size_t i = 0; i < keys_.size(); ++i) places.emplace(keys_[i], i);
    std::vector<State> states(std::size(entries));
    keys_.clear();
    for (const auto& entry : entries) {
      const std::uint64_t wanted = key_of(entry);
      if (const auto found = places.lower_bound(wanted); found != places.end() && found->first == wanted) {
        states[keys_.size()] = std::move(states_[found->second]);
        places.erase(found);
      }
      keys_.push_back(wanted);
    }
    states_ = std::move(states);
    return true;
  }
  void clear() {
    keys_.clear();
    states_.clear();
  }

  const std::vector<std::uint64_t>& keys() const { return keys_; }
  std::size_t size() const { return states_.size(); }
  State& operator[](std::size_t index) { return states_[index]; }
  const State& operator[](std::size_t index) const { return states_[index]; }
  auto begin() { return states_.begin(); }
  auto end() { return states_.end(); }
  auto begin() const { return states_.begin(); }
  auto end() const { return states_.end(); }

 private:
  std::vector<std::uint64_t> keys_;
  std::vector<State> states_;
};

}  // namespace lambent
