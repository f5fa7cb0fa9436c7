// Keeps the largest or smallest of the numbers that a test holds against a bound. std::max(x, NaN) is x, so
// with std::max a test passes whose shader or baker gives only NaN. Here NaN stays, and every comparison with
// it fails. tests/docs/helpers_test.cpp keeps std::max and std::min out of such places.
#pragma once

#include <cmath>
#include <concepts>
#include <iterator>
#include <limits>
#include <type_traits>

namespace lambent::testing {

// Returns the larger number, or NaN if one of the two is NaN.
template <std::floating_point A, std::floating_point B>
std::common_type_t<A, B> larger(A a, B b) {
  return a > b || std::isnan(a) ? a : b;
}

// Returns the smaller number, or NaN if one of the two is NaN.
template <std::floating_point A, std::floating_point B>
std::common_type_t<A, B> smaller(A a, B b) {
  return a < b || std::isnan(a) ? a : b;
}

// Returns the largest difference between numbers at the same place. It is NaN if one of the differences is,
// if there are not as many numbers in both, and if there are none: nothing was compared then.
template <typename Numbers, typename Expected>
double largestDifference(const Numbers& numbers, const Expected& expected) {
  if (std::size(numbers) != std::size(expected) || std::size(numbers) == 0)
    return std::numeric_limits<double>::quiet_NaN();
  double largest = 0.0;
  auto wanted = std::begin(expected);
  for (const auto& number : numbers) largest = larger(largest, std::abs(double{number} - double{*wanted++}));
  return largest;
}

// Returns the root mean square of these differences, relative to that of the expected numbers. It is NaN
// where largestDifference() is.
template <typename Numbers, typename Expected>
double relativeDifference(const Numbers& numbers, const Expected& expected) {
  if (std::size(numbers) != std::size(expected)) return std::numeric_limits<double>::quiet_NaN();
  double wrong = 0.0, all = 0.0;
  auto wanted = std::begin(expected);
  for (const auto& number : numbers) {
    const double is = double{number}, should = double{*wanted++};
    wrong += (is - should) * (is - should);
    all += should * should;
  }
  return std::sqrt(wrong / all);
}

}  // namespace lambent::testing
