// From a number of bands that is known when the program runs to one that is known when it is compiled.
#pragma once

#include <cassert>
#include <type_traits>
#include <utility>

#include "runtime/sh/basis.hpp"

namespace lambent::sh {

// Calls f with std::integral_constant<int, order>; order 1..Most.
template <int Most, typename F>
void withOrder(int order, F&& f) {
  assert(order >= 1 && order <= Most);
  detail::unrolled(std::make_integer_sequence<int, Most>{}, [&](auto index) {
    if (order == index + 1) f(std::integral_constant<int, index + 1>{});
  });
}

}  // namespace lambent::sh
