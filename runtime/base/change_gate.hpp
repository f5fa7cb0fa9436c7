// Tells whether something must be made anew: keeps the values that it was last made from, such as version
// counters, switches and sizes. A value type without an idea of what the values mean.
#pragma once

#include <optional>
#include <tuple>

namespace lambent {

template <class... Values>
class ChangeGate {
 public:
  // Whether any value is another than at the last call, as all are at the first call. Keeps the values.
  bool renew(const Values&... values) {
    if (holds(values...)) return false;
    kept_.emplace(values...);
    return true;
  }
  // Whether the last call of renew() had these values.
  bool holds(const Values&... values) const { return kept_ == std::tuple<Values...>(values...); }
  // Whether renew() was called at all, and not forgotten.
  bool known() const { return kept_.has_value(); }
  // Lets the next call count as the first.
  void forget() { kept_.reset(); }

 private:
  std::optional<std::tuple<Values...>> kept_;
};

}  // namespace lambent
