#include "baker/bake/option_rows.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <limits>
#include <optional>
#include <tuple>
#include <type_traits>

#include <fmt/format.h>

#include "baker/effects/neighborhood/grid_placement.hpp"
#include "baker/plan/local_light.hpp"

namespace lambent::baker {

namespace {

// ---- what a row consists of

template <class T>
struct Word {
  std::string_view word;
  std::conditional_t<std::is_same_v<T, std::string>, std::string_view, T> value;
};

// Numbers themselves; the points of a grid along each axis.
template <class T>
using LimitOf = std::conditional_t<std::is_same_v<T, glm::uvec3>, std::uint32_t, T>;

template <class T>
struct Limits {
  LimitOf<T> least{}, greatest{};
  bool open = false;                 // both ends excluded
  bool usage = false;                // what lies outside is wrong usage: refused with the word
  std::string_view wrong{}, mend{};  // instead of "is not between"; what to do
};

template <class T>
struct TypedRow {
  std::string_view name, setting, kind;
  T BakeOptions::*member;
  std::string_view help;
  std::array<Word<T>, 3> words{};  // those with an empty word are none
  std::optional<Limits<T>> limits{};
  std::string (*record)(const BakeOptions&) = nullptr;  // none: the word
};

template <class T>
constexpr bool kHasLimits = std::is_arithmetic_v<LimitOf<T>>;
template <class T>
constexpr bool kOnlyWords = std::is_same_v<T, Quality> || std::is_same_v<T, std::optional<bool>>;

// ---- the table

using B = BakeOptions;

std::string recordRays(const BakeOptions& o) {
  return fmt::format("{}", o.effectiveRays());
}
std::string recordError(const BakeOptions& o) {
  return fmt::format("{}", o.effectiveErrorBound());
}
std::string recordRefine(const BakeOptions& o) {
  return fmt::format("{}", o.effectiveRefineBound());
}
std::string recordFit(const BakeOptions& o) {
  return o.fitsMatte() ? "on" : o.fitsGlossy() ? "glossy" : "off";
}

template <class T>
constexpr T kMost = std::numeric_limits<T>::max();

constexpr std::tuple kRows{
    TypedRow<Quality>{
        .name = "quality",
        .setting = "",
        .kind = "NAME",
        .member = &B::quality,
        .help = "draft, standard (default) or high: rays and error bound together",
        .words = {{{"draft", Quality::Draft}, {"standard", Quality::Standard}, {"high", Quality::High}}}},
    TypedRow<int>{.name = "order",
                  .setting = "order",
                  .kind = "N",
                  .member = &B::order,
                  .help = "Bands of spherical harmonics, 1..8; order² coefficients",
                  .limits = Limits<int>{.least = 1, .greatest = 8, .mend = "5 is the default"}},
    TypedRow<int>{.name = "glossy-order",
                  .setting = "glossyOrder",
                  .kind = "N",
                  .member = &B::glossy_order,
                  .help = "Bands of the light that glossy surfaces reflect, 4..6",
                  .limits = Limits<int>{.least = 4, .greatest = 6, .mend = "5 is the default"}},
    TypedRow<std::uint32_t>{
        .name = "rays",
        .setting = "rays",
        .kind = "N",
        .member = &B::rays,
        .help = "Rays per sample over its hemisphere; default 256, 1024 or 4096 by quality",
        .words = {{{"auto", 0}}},
        .limits =
            Limits<std::uint32_t>{
                .least = 128, .greatest = 1u << 20, .mend = "leave it out to take what --quality stands for"},
        .record = &recordRays},
    TypedRow<int>{
        .name = "bounces",
        .setting = "bounces",
        .kind = "N",
        .member = &B::bounces,
        .help = "Interreflections between surfaces, 0..64; 0: direct light with shadows only, and single "
                "scattering in volumes, which else scatter as often as they do; default: until what is left "
                "out is far under the error bound",
        .words = {{{"auto", -1}}},
        .limits = Limits<int>{.least = 0,
                              .greatest = B::kMostBounces,
                              .usage = true,
                              .mend = "leave it out to bake as many as the error bound asks for"}},
    TypedRow<std::uint64_t>{
        .name = "max-memory",
        .setting = "",
        .kind = "BYTES",
        .member = &B::memory_bytes,
        .help = "Memory for what passes keep, in bytes or like 4GB; default half of the machine's. What does "
                "not fit is computed again: slower, the same result",
        .words = {{{"auto", 0}}}},
    TypedRow<float>{
        .name = "error",
        .setting = "errorBound",
        .kind = "E",
        .member = &B::error_bound,
        .help = "Bound on the coding error, relative RMS of shaded radiance; default 0.01, 0.003 or "
                "0.001 by quality, of glossy surfaces 0.03, 0.015 or 0.005",
        .words = {{{"auto", 0.0f}}},
        .limits = Limits<float>{.least = 0.0f, .greatest = 1.0f, .open = true, .mend = "0.003 means 0.3 %"},
        .record = &recordError},
    TypedRow<float>{
        .name = "max-edge",
        .setting = "maxEdge",
        .kind = "M",
        .member = &B::max_edge_m,
        .help = "Split edges longer than this (scene units), so that large faces catch shadows",
        .limits = Limits<float>{.least = 0.0f,
                                .greatest = kMost<float>,
                                .wrong = "is not a length",
                                .mend = "give a positive number in the scene's units, or leave it out"}},
    TypedRow<float>{
        .name = "refine",
        .setting = "refineBound",
        .kind = "E|auto|off",
        .member = &B::refine_bound,
        .help =
            "Split edges where shadows change, until interpolation errs by less than E, relative RMS; auto "
            "(default): 0.02, 0.014 or 0.007 by quality; off: keep the vertices as they are",
        .words = {{{"auto", -1.0f}, {"off", 0.0f}}},
        .limits = Limits<float>{.least = 0.0f,
                                .greatest = 1.0f,
                                .open = true,
                                .usage = true,
                                .mend = "auto takes what --quality stands for"},
        .record = &recordRefine},
    TypedRow<std::optional<bool>>{
        .name = "fit",
        .setting = "fit",
        .kind = "auto|on|off",
        .member = &B::fit,
        .help = "Fit light at vertices to what rays from inside the faces see, so that interpolation shows "
                "faces best, of matte surfaces direct light alone: on, off (what the vertices see) or auto "
                "(default): on glossy surfaces, but for drafts",
        .words = {{{"auto", std::nullopt}, {"on", true}, {"off", false}}},
        .record = &recordFit},
    TypedRow<int>{
        .name = "light-samples",
        .setting = "lightSamples",
        .kind = "N|auto",
        .member = &B::light_samples,
        .help = "Points of each cell at which light from outside is sampled, 1..32; 1 for a group: light at "
                "infinity. auto (default): by how near light comes, shared out over the group",
        .words = {{{"auto", 0}}},
        .limits = Limits<int>{.least = 1,
                              .greatest = static_cast<int>(kMostLightSamples),
                              .usage = true,
                              .mend = "auto chooses by how near light comes"}},
    TypedRow<glm::uvec3>{
        .name = "neighborhood-grid",
        .setting = "neighborhoodGrid",
        .kind = "XxYxZ",
        .member = &B::neighborhood_grid,
        .help =
            "Points of neighborhood grids along their longest, middle and shortest side, 2..256 each; auto "
            "(default): 64x64x8 where receivers are on one side only, else 32x32x32; for bodies that the "
            "scene does not name a quarter of that",
        .words = {{{"auto", glm::uvec3(0u)}}},
        .limits = Limits<glm::uvec3>{.least = 2, .greatest = kMostGridPoints, .mend = "64x64x8 is usual"}},
    TypedRow<glm::uvec3>{
        .name = "volume-grid",
        .setting = "volumeGrid",
        .kind = "N|XxYxZ",
        .member = &B::volume_grid,
        .help = "Voxels of the grid that a volume's transfer is baked on, 1..256 along each axis; default 32",
        .limits = Limits<glm::uvec3>{.least = 1, .greatest = 256, .mend = "32 is the default"}},
    TypedRow<std::string>{.name = "effects",
                          .setting = "effects",
                          .kind = "LIST",
                          .member = &B::effects,
                          .help = "auto: what the scene calls for; or a list of effects"},
    TypedRow<unsigned>{.name = "threads",
                       .setting = "",
                       .kind = "N",
                       .member = &B::threads,
                       .help = "Threads; default all. The result does not depend on it",
                       .words = {{{"auto", 0}}}}};

// A member without a row does not compile: it changes how many names this needs.
[[maybe_unused]] auto membersOf(const BakeOptions& options) {
  const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o] = options;
  return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o);
}
static_assert(std::tuple_size_v<decltype(membersOf(BakeOptions()))> == std::tuple_size_v<decltype(kRows)>,
              "every member of BakeOptions has a row");

// ---- words and values

// All of the text, or nothing.
template <class T>
bool readNumber(std::string_view text, T& value) {
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && at == end;
}

// "4GB", "512 mib": units of 1024.
bool readBytes(std::string_view text, std::uint64_t& value) {
  const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
  std::string unit;
  for (const char c : text.substr(digits))
    if (c != ' ') unit += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
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

// What of a value lies outside the limits; none where all is well, and where a word stands for the value.
template <class T>
std::optional<LimitOf<T>> outside(const TypedRow<T>& row, const T& value) {
  if (!row.limits) return std::nullopt;
  for (const Word<T>& word : row.words)
    if (!word.word.empty() && word.value == value) return std::nullopt;
  if constexpr (std::is_same_v<T, glm::uvec3>) {
    for (int axis = 0; axis < 3; ++axis)
      if (!within(*row.limits, value[axis])) return value[axis];
    return std::nullopt;
  } else {
    return within(*row.limits, value) ? std::nullopt : std::optional(value);
  }
}

// "is neither auto nor between 1 and 32"
template <class T>
std::string notOfItsKind(const TypedRow<T>& row) {
  std::vector<std::string> kinds;
  for (const Word<T>& word : row.words)
    if (!word.word.empty()) kinds.emplace_back(word.word);
  if constexpr (std::is_same_v<T, glm::uvec3>)
    kinds.insert(kinds.end(), {"N", "XxYxZ"});
  else if constexpr (std::is_same_v<T, std::uint64_t>)
    kinds.emplace_back("a size in memory");
  else if constexpr (std::is_arithmetic_v<T>)
    kinds.push_back(row.limits && row.limits->usage
                        ? fmt::format("between {} and {}", row.limits->least, row.limits->greatest)
                    : std::is_integral_v<T> ? "a whole number"
                                            : "a number");
  std::string text = kinds.size() == 1 ? "is not " : "is neither ";
  for (std::size_t i = 0; i < kinds.size(); ++i) text += (i > 0 ? " nor " : "") + kinds[i];
  return text;
}

// ---- rows without their types

template <std::size_t I>
std::string wordOf(const BakeOptions& options) {
  const auto& row = std::get<I>(kRows);
  return textOf(row, options.*row.member);
}

template <std::size_t I>
bool readWord(BakeOptions& options, std::string_view word) {
  const auto& row = std::get<I>(kRows);
  return readValue(row, word, options.*row.member);
}

template <std::size_t I>
Result<void> putWord(BakeOptions& options, std::string_view word) {
  const auto& row = std::get<I>(kRows);
  auto value = options.*row.member;
  bool good = readValue(row, word, value);
  if constexpr (std::is_arithmetic_v<decltype(value)>)
    if (good && row.limits && row.limits->usage)  // 0 is not another word for "off"
      good = std::ranges::any_of(row.words, [&](const auto& w) { return w.word == word; }) ||
             within(*row.limits, value);
  if (!good)
    return fail(fmt::format("--{}", row.name), fmt::format("{} {}", word, notOfItsKind(row)),
                fmt::format("give {}", row.kind));
  options.*row.member = value;
  return {};
}

template <std::size_t I>
Result<void> checkValue(const BakeOptions& options) {
  const auto& row = std::get<I>(kRows);
  if constexpr (kHasLimits<std::remove_cvref_t<decltype(options.*row.member)>>) {
    const auto wrong = outside(row, options.*row.member);
    if (!wrong) return {};
    const auto& limits = *row.limits;
    return fail(fmt::format("--{}", row.name),
                limits.wrong.empty()
                    ? fmt::format("{} is not between {} and {}", *wrong, limits.least, limits.greatest)
                    : fmt::format("{} {}", *wrong, limits.wrong),
                std::string(limits.mend));
  }
  return {};
}

template <std::size_t I>
OptionRow optionRow() {
  const auto& row = std::get<I>(kRows);
  using T = std::remove_cvref_t<decltype(BakeOptions().*row.member)>;
  OptionRow out{.name = row.name, .setting = row.setting, .kind = row.kind, .help = row.help};
  for (const Word<T>& word : row.words)
    if (!word.word.empty()) out.words.push_back(word.word);
  out.only_words = kOnlyWords<T>;
  out.shows_default = out.words.empty() && !std::is_same_v<T, glm::uvec3> && BakeOptions().*row.member != T{};
  out.word = &wordOf<I>;
  out.record = row.record;
  if (!out.record) out.record = &wordOf<I>;
  out.put = &putWord<I>;
  out.read = &readWord<I>;
  out.check = &checkValue<I>;
  return out;
}

}  // namespace

std::span<const OptionRow> optionRows() {
  static const auto kErased = []<std::size_t... I>(std::index_sequence<I...>) {
    return std::array{optionRow<I>()...};
  }
  (std::make_index_sequence<std::tuple_size_v<decltype(kRows)>>{});
  return kErased;
}

const OptionRow* findOption(std::string_view name) {
  const auto rows = optionRows();
  const auto found = std::ranges::find(rows, name, &OptionRow::name);
  return found == rows.end() ? nullptr : &*found;
}

Result<void> putOption(BakeOptions& options, std::string_view name, std::string_view word) {
  if (const OptionRow* row = findOption(name)) return row->put(options, word);
  std::string names;
  for (const OptionRow& row : optionRows()) names += fmt::format("{}{}", names.empty() ? "" : ", ", row.name);
  return fail(std::string(name), "is no option of a bake", "give " + names);
}

Result<void> checkOptions(const BakeOptions& options) {
  for (const OptionRow& row : optionRows())
    if (auto checked = row.check(options); !checked) return checked;
  return {};
}

}  // namespace lambent::baker
