// Turns an order that is known at run time into a compile-time constant.
#pragma once

#include <cassert>
#include <type_traits>
#include <utility>

#include "runtime/sh/basis.hpp"

namespace lambent::sh {

// Calls f with std::integral_constant<int, order>. `order` is in 1..Most.
template <int Most, typename F>
void withOrder(int order, F&& f) {
  assert(order >= 1 && order <= Most);
  detail::unrolled(std::make_integer_sequence<int, Most>{}, [&](auto index) {
    if (order == index + 1) f(std::integral_constant<int, index + 1>{});
  });
}

}  // namespace lambent::sh
