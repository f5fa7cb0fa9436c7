// A row of the table of options that knows the type of its value: it reads words, writes them and has limits.
// The header is used inside this room only; option_rows.cpp holds the table and hides the types from everyone
// else. All functions are pure.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "baker/bake/options.hpp"
#include "runtime/base/lower_case.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker::typed_options {

// A word that stands for a value, as "auto" does.
template <class T>
struct Word {
  std::string_view word;
  std::conditional_t<std::is_same_v<T, std::string>, std::string_view, T> value;
};

// A grid is limited in its points along each axis, every other kind in its value.
template <class T>
using LimitOf = std::conditional_t<std::is_same_v<T, glm::uvec3>, std::uint32_t, T>;

template <class T>
struct Limits {
  LimitOf<T> least{}, greatest{};
  bool open = false;                // both ends are excluded
  std::string_view kind{}, hint{};  // instead of "between", as "a length"; what to do
};

template <class T>
struct TypedRow {
  std::string_view name, group, setting, kind;
  T BakeOptions::*member;
  std::string_view help;
  std::array<Word<T>, 3> words{};  // unused ones have an empty word
  std::optional<Limits<T>> limits{};
  std::string (*record)(const BakeOptions&) = nullptr;  // null: the word is recorded
  // Values that take the place of each "{}" in the help, listed for all qualities.
  std::array<std::string (*)(const BakeOptions&), 2> help_values{};
  Result<void> (*check)(const BakeOptions&) = nullptr;  // what limits cannot say; null: nothing
  std::string_view former{};                            // see OptionRow
  bool share = false;                                   // a number that may be given in per cent too, as "2%"
};

template <class T>
constexpr bool kHasLimits = std::is_arithmetic_v<LimitOf<T>>;
template <class T>
constexpr bool kOnlyWords = std::is_same_v<T, Quality> || std::is_same_v<T, std::optional<bool>>;

template <class T>
constexpr T kMost = std::numeric_limits<T>::max();

// Reads a number that takes up the whole text.
template <class T>
bool readNumber(std::string_view text, T& value) {
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && at == end;
}

// Reads a size such as "4GB" or "512 mib", in units of 1024.
inline bool readBytes(std::string_view text, std::uint64_t& value) {
  const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
  std::string unit = lowerCase(text.substr(digits));
  std::erase(unit, ' ');
  if (unit.ends_with('b')) unit.pop_back();
  if (unit.ends_with('i')) unit.pop_back();
  const std::size_t power = std::string_view(" kmgtp").find(unit.empty() ? " " : unit);
  if (unit.size() > 1 || power == std::string_view::npos || !readNumber(text.substr(0, digits), value))
    return false;
  constexpr std::uint64_t kAll = kMost<std::uint64_t>;
  if (value > (kAll >> (10 * power))) return false;
  value <<= 10 * power;
  return true;
}

template <class T>
bool readValue(const TypedRow<T>& row, std::string_view text, T& value) {
  for (const Word<T>& word : row.words)
    if (!word.word.empty() && word.word == text) {
      value = word.value;
      return true;
    }
  if constexpr (kOnlyWords<T>) {
    return false;
  } else if constexpr (std::is_same_v<T, std::string>) {
    value = text;
    return true;
  } else if constexpr (std::is_same_v<T, glm::uvec3>) {
    const auto grid = gridSizeFrom(text);
    value = grid.value_or(value);
    return grid.has_value();
  } else if constexpr (std::is_same_v<T, std::uint64_t>) {
    return readBytes(text, value);
  } else if (row.share && text.ends_with('%')) {
    double per_cent = 0.0;
    if (!readNumber(text.substr(0, text.size() - 1), per_cent)) return false;
    value = static_cast<T>(per_cent / 100.0);
    return true;
  } else {
    return readNumber(text, value);
  }
}

template <class T>
std::string textOf(const TypedRow<T>& row, const T& value) {
  for (const Word<T>& word : row.words)
    if (!word.word.empty() && word.value == value) return std::string(word.word);
  if constexpr (kOnlyWords<T>)
    return {};
  else if constexpr (std::is_same_v<T, glm::uvec3>)
    return fmt::format("{}x{}x{}", value.x, value.y, value.z);
  else
    return fmt::format("{}", value);
}

template <class T>
bool within(const Limits<T>& limits, LimitOf<T> value) {
  if (limits.open) return value > limits.least && value < limits.greatest;
  return value >= limits.least && value <= limits.greatest;
}

// Returns the number that lies outside the limits, or nothing if there is none.
template <class T>
std::optional<LimitOf<T>> outside(const TypedRow<T>& row, const T& value) {
  if (!row.limits) return std::nullopt;
  if constexpr (std::is_same_v<T, glm::uvec3>) {
    for (int axis = 0; axis < 3; ++axis)
      if (!within(*row.limits, value[axis])) return value[axis];
    return std::nullopt;
  } else {
    return within(*row.limits, value) ? std::nullopt : std::optional(value);
  }
}

template <class T>
Result<void> checkMore(const TypedRow<T>& row, const BakeOptions& options) {
  return row.check ? row.check(options) : Result<void>();
}

// Says what a word should have been: "is neither auto nor between 1 and 32".
template <class T>
std::string notOfItsKind(const TypedRow<T>& row) {
  std::vector<std::string> kinds;
  for (const Word<T>& word : row.words)
    if (!word.word.empty()) kinds.emplace_back(word.word);
  if constexpr (std::is_same_v<T, glm::uvec3>)
    kinds.push_back(fmt::format("N or XxYxZ of {} to {} each", row.limits->least, row.limits->greatest));
  else if constexpr (std::is_arithmetic_v<T>)
    kinds.push_back(row.limits->kind.empty()
                        ? fmt::format("between {} and {}", row.limits->least, row.limits->greatest)
                        : std::string(row.limits->kind));
  std::string text = kinds.size() == 1 ? "is not " : "is neither ";
  for (std::size_t i = 0; i < kinds.size(); ++i) text += (i > 0 ? " nor " : "") + kinds[i];
  return text;
}

}  // namespace lambent::baker::typed_options
