// What somebody keeps for every entry of a list that others change, index for index. Entries come and go, and
// indices with them; follow() moves every state to where its entry is now, by a key that an entry keeps for
// life. Entries that are new have a default-constructed state, that of those that went is dropped: so no
// state is ever taken for that of another entry. Of entries with the same key the first stays the first.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <utility>
#include <vector>

namespace lambent {

template <class State>
class KeyedState {
 public:
  // key(entry): an integer of at most 64 bits, or a pointer to the member. True if anything moved, came or
  // went; cheap where nothing did.
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
