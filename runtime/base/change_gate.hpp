// Tells whether something must be made anew. It keeps the values that it was last made from, such as version
// counters, switches and sizes, without knowing what they mean.
#pragma once

#include <optional>
#include <tuple>

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

}  // namespace lambent
