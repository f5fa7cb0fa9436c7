#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <tuple>
#include <type_traits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "baker/bake/options.hpp"
#include "baker/effects/neighborhood/grid_placement.hpp"
#include "baker/plan/effect_plan.hpp"
#include "runtime/base/lower_case.hpp"

namespace lambent::baker {

namespace {

// Headings of groups in the help.
constexpr std::string_view kAccuracy = "Accuracy", kVertices = "Vertices", kGrids = "What is baked",
                           kMachine = "Machine";

// Settings that a bound on pictures chooses are recorded as "auto"; the bundle says of each group which they
// are.
std::string recordRays(const BakeOptions& o) {
  return o.picture_bound > 0.0f && o.rays == 0 ? "auto" : fmt::format("{}", o.effectiveRays());
}
std::string recordCodes(const BakeOptions& o) {
  return o.picture_bound > 0.0f && o.error_bound == 0.0f ? "auto"
                                                         : fmt::format("{}", o.effectiveErrorBound());
}
std::string recordGlossyError(const BakeOptions& o) {
  return fmt::format("{}", o.effectiveGlossyErrorBound());
}
std::string recordRefine(const BakeOptions& o) {
  return o.picture_bound > 0.0f && o.refine_bound < 0.0f ? "auto"
                                                         : fmt::format("{}", o.effectiveRefineBound());
}
std::string recordFit(const BakeOptions& o) {
  return o.fitsGlossy() ? "on" : o.fitsDiffuse() ? "diffuse" : "off";
}

// Lists what the options of each quality come to: "256, 1024 or 4096".
std::string byQuality(std::string (*value)(const BakeOptions&)) {
  return fmt::format("{}, {} or {}", value({.quality = Quality::Draft}),
                     value({.quality = Quality::Standard}), value({.quality = Quality::High}));
}

// ---- values of any type

template <class T>
constexpr bool kIsGrid = std::is_same_v<T, glm::uvec3>;

// Returns the value that a word stands for.
template <class T>
T valueOf(const OptionRow::Word& word) {
  if constexpr (std::is_same_v<T, std::string>)
    return {};
  else if constexpr (std::is_same_v<T, std::optional<bool>>)
    return word.value < 0.0 ? std::nullopt : std::optional(word.value > 0.0);
  else if constexpr (kIsGrid<T>)
    return T(static_cast<std::uint32_t>(word.value));
  else
    return static_cast<T>(word.value);
}

// Reads a number that takes up the whole text.
template <class T>
bool readNumber(std::string_view text, T& value) {
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && at == end;
}

// Reads a size such as "4GB" or "512 mib", in units of 1024.
bool readBytes(std::string_view text, std::uint64_t& value) {
  const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
  std::string unit = lowerCase(text.substr(digits));
  std::erase(unit, ' ');
  if (unit.ends_with('b')) unit.pop_back();
  if (unit.ends_with('i')) unit.pop_back();
  const std::size_t power = std::string_view(" kmgtp").find(unit.empty() ? " " : unit);
  if (unit.size() > 1 || power == std::string_view::npos || !readNumber(text.substr(0, digits), value))
    return false;
  if (value > (std::numeric_limits<std::uint64_t>::max() >> (10 * power))) return false;
  value <<= 10 * power;
  return true;
}

template <class T>
bool readValue(const OptionRow& row, std::string_view text, T& value) {
  for (const OptionRow::Word& word : row.words)
    if (word.word == text) {
      value = valueOf<T>(word);
      return true;
    }
  if constexpr (std::is_same_v<T, std::string>) {
    value = text;
    return true;
  } else if constexpr (kIsGrid<T>) {
    const auto grid = gridSizeFrom(text);
    value = grid.value_or(value);
    return grid.has_value();
  } else if constexpr (std::is_same_v<T, std::uint64_t>) {
    return readBytes(text, value);
  } else if constexpr (!std::is_arithmetic_v<T>) {
    return false;
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
std::string textOf(const OptionRow& row, const T& value) {
  for (const OptionRow::Word& word : row.words)
    if (valueOf<T>(word) == value) return std::string(word.word);
  if constexpr (kIsGrid<T>)
    return fmt::format("{}x{}x{}", value.x, value.y, value.z);
  else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>)
    return fmt::format("{}", value);
  else
    return {};
}

// Returns whether the value lies outside the limits, which NaN does.
template <class T>
bool isOutside(const OptionRow& row, const T& value) {
  if constexpr (kIsGrid<T>) {
    return isOutside(row, value.x) || isOutside(row, value.y) || isOutside(row, value.z);
  } else if constexpr (std::is_arithmetic_v<T>) {
    const auto number = static_cast<double>(value);
    return row.share ? !(number > 0.0 && number < 1.0) : !(number >= row.least && number <= row.greatest);
  } else {
    return false;
  }
}

// Says what a word should have been: "is neither auto nor between 1 and 32".
std::string notOfItsKind(const OptionRow& row) {
  std::vector<std::string> kinds;
  for (const OptionRow::Word& word : row.words) kinds.emplace_back(word.word);
  const std::string between =
      fmt::format("{:.0f} {} {:.0f}", row.least, row.grid() ? "to" : "and", row.greatest);
  if (row.grid())
    kinds.push_back(fmt::format("N or XxYxZ of {} each", between));
  else if (row.share)
    kinds.emplace_back("a share between 0 and 1");
  else if (!row.only_words)
    kinds.push_back(row.limits.empty() ? "between " + between : std::string(row.limits));
  return fmt::format("is {} {}", kinds.size() == 1 ? "not" : "neither", fmt::join(kinds, " nor "));
}

// Checks what limits of a row cannot express.
Result<void> checkMore(const OptionRow& row, const BakeOptions& options) {
  if (row.name != "effects") return {};
  if (const auto known = effectsNamed(options.effects); !known) return failAgain(known.error());
  return {};
}

// A member of BakeOptions without a row does not compile, since it changes how many names this needs.
[[maybe_unused]] auto membersOf(const BakeOptions& options) {
  const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] = options;
  return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p);
}

}  // namespace

std::string OptionRow::word(const BakeOptions& options) const {
  return std::visit([&](auto of) { return textOf(*this, options.*of); }, member);
}

std::string OptionRow::record(const BakeOptions& options) const {
  return recorded ? recorded(options) : word(options);
}

bool OptionRow::read(BakeOptions& options, std::string_view word) const {
  return std::visit([&](auto of) { return readValue(*this, word, options.*of); }, member);
}

Result<void> OptionRow::put(BakeOptions& options, std::string_view word) const {
  BakeOptions tried = options;
  // A number is no other word for what a word stands for: 0 does not mean "auto".
  const bool named = std::ranges::find(words, word, &Word::word) != words.end();
  const bool good = read(tried, word) &&
                    (named || std::visit([&](auto of) { return !isOutside(*this, tried.*of); }, member));
  if (!good)
    return fail(fmt::format("--{}", name),
                word.empty() ? "is empty" : fmt::format("{} {}", word, notOfItsKind(*this)),
                hint.empty() ? fmt::format("give {}", kind) : std::string(hint));
  if (auto checked = checkMore(*this, tried); !checked) return checked;
  options = std::move(tried);
  return {};
}

Result<void> OptionRow::check(const BakeOptions& options) const {
  const bool good = std::visit(
      [&](auto of) {
        const auto& value = options.*of;
        using T = std::remove_cvref_t<decltype(value)>;
        return std::ranges::any_of(words, [&](const Word& w) { return valueOf<T>(w) == value; }) ||
               !isOutside(*this, value);
      },
      member);
  if (!good)
    return fail(fmt::format("--{}", name), fmt::format("{} {}", word(options), notOfItsKind(*this)),
                std::string(hint));
  return checkMore(*this, options);
}

std::span<const OptionRow> optionRows() {
  using B = BakeOptions;
  static const std::array kRows{
      OptionRow{.name = "quality",
                .group = kAccuracy,
                .kind = "draft|standard|high",
                .member = &B::quality,
                .help = "Rays, refinement and error bounds together; default standard",
                .words = {{"draft", 0}, {"standard", 1}, {"high", 2}},
                .only_words = true},
      OptionRow{.name = "order",
                .group = kAccuracy,
                .setting = "order",
                .kind = "N",
                .member = &B::order,
                .help = "Bands of spherical harmonics, 1..8; order² coefficients",
                .least = 1,
                .greatest = 8,
                .shows_default = true,
                .hint = "5 is the default"},
      OptionRow{.name = "glossy-order",
                .group = kAccuracy,
                .setting = "glossyOrder",
                .kind = "N",
                .member = &B::glossy_order,
                .help = "Bands of the light that glossy surfaces reflect, 4..6",
                .least = 4,
                .greatest = 6,
                .shows_default = true,
                .hint = "5 is the default"},
      OptionRow{
          .name = "rays",
          .group = kAccuracy,
          .setting = "rays",
          .kind = "N",
          .member = &B::rays,
          .help = "Rays per sample over its hemisphere; default " + byQuality(&recordRays) + " by quality",
          .words = {{"auto", 0}},
          .least = 128,
          .greatest = 1u << 20,
          .hint = "leave it out to take what --quality stands for",
          .recorded = &recordRays},
      OptionRow{
          .name = "bounces",
          .group = kAccuracy,
          .setting = "bounces",
          .kind = "N",
          .member = &B::bounces,
          .help =
              "Interreflections between surfaces, 0..64; 0: direct light with shadows only, and single "
              "scattering in volumes, which else scatter as often as they do; default: until what is left "
              "out is far under the error bound",
          .words = {{"auto", -1}},
          .greatest = B::kMostBounces,
          .hint = "leave it out to bake as many as the error bound asks for"},
      OptionRow{.name = "max-memory",
                .group = kMachine,
                .kind = "BYTES",
                .member = &B::memory_bytes,
                .help = "The memory that the bake takes if it can, in bytes or like 4GB; default half of the "
                        "machine's. "
                        "What passes cannot keep in it is computed again: slower, the same result",
                .words = {{"auto", 0}},
                .least = 1u << 16,
                .greatest = 0x1p64,
                .limits = "a size of 64KB or more",
                .hint = "give bytes or a unit, as 4GB"},
      OptionRow{
          .name = "error",
          .group = kAccuracy,
          .setting = "pictureBound",
          .kind = "E",
          .member = &B::picture_bound,
          .help =
              "Bound on the error of pictures of surfaces, relative RMS over real lights, by rays, "
              "interpolation and codes together. The bake chooses --rays, --refine and --codes, as far as "
              "they are not given, and says what it reached",
          .words = {{"none", 0}},
          .share = true,
          .hint = "write 2 % as 0.02 or 2%"},
      OptionRow{.name = "codes",
                .group = kAccuracy,
                .setting = "errorBound",
                .kind = "E",
                .member = &B::error_bound,
                .help = "Bound on the error of codes alone, relative RMS of shaded radiance; default " +
                        byQuality(&recordCodes) + " by quality, of glossy surfaces " +
                        byQuality(&recordGlossyError),
                .words = {{"auto", 0}},
                .share = true,
                .hint = "write 0.3 % as 0.003 or 0.3%",
                .recorded = &recordCodes},
      OptionRow{.name = "max-edge",
                .group = kVertices,
                .setting = "maxEdge",
                .kind = "M",
                .member = &B::max_edge_m,
                .help = "Split edges longer than this (scene units), so that large faces catch shadows",
                .greatest = double{std::numeric_limits<float>::max()},
                .limits = "a length",
                .hint = "give a positive number in the scene's units, or leave it out"},
      OptionRow{
          .name = "refine",
          .group = kVertices,
          .setting = "refineBound",
          .kind = "E|auto|off",
          .member = &B::refine_bound,
          .help =
              "Split edges where shadows change, until interpolation errs by less than E, relative RMS; auto "
              "(default): " +
              byQuality(&recordRefine) + " by quality; off: keep the vertices as they are",
          .words = {{"auto", -1}, {"off", 0}},
          .share = true,
          .hint = "write 2 % as 0.02 or 2%; auto takes what --quality stands for",
          .recorded = &recordRefine},
      OptionRow{
          .name = "fit",
          .group = kVertices,
          .setting = "fit",
          .kind = "auto|on|off",
          .member = &B::fit,
          .help =
              "Fit light at vertices to what rays from inside the faces see, so that interpolation shows "
              "faces best: on, off (what the vertices see) or auto (default): on, but not on glossy surfaces "
              "of drafts",
          .words = {{"auto", -1}, {"on", 1}, {"off", 0}},
          .only_words = true,
          .recorded = &recordFit},
      OptionRow{
          .name = "light-probes",
          .group = kGrids,
          .setting = "lightSamples",
          .kind = "N|auto",
          .member = &B::light_probes,
          .help =
              "Points of each cell at which light from outside is sampled, 1..32; 1 for a group: light at "
              "infinity. auto (default): by how near light comes, shared out over the group",
          .words = {{"auto", 0}},
          .least = 1,
          .greatest = kMostLightProbes,
          .hint = "auto chooses by how near light comes",
          .former = "light-samples"},
      OptionRow{
          .name = "neighborhood-grid",
          .group = kGrids,
          .setting = "neighborhoodGrid",
          .kind = "XxYxZ",
          .member = &B::neighborhood_grid,
          .help =
              "Points of neighborhood grids along their longest, middle and shortest side, 2..256 each; auto "
              "(default): 64x64x8 where receivers are on one side only, else 32x32x32; for bodies that the "
              "scene does not name a quarter of that",
          .words = {{"auto", 0}},
          .least = 2,
          .greatest = kMostGridPoints,
          .hint = "64x64x8 is usual"},
      OptionRow{
          .name = "volume-grid",
          .group = kGrids,
          .setting = "volumeGrid",
          .kind = "N|XxYxZ",
          .member = &B::volume_grid,
          .help =
              "Voxels of the grid that a volume's transfer is baked on, 1..256 along each axis; default 32",
          .least = 1,
          .greatest = 256,
          .hint = "32 is the default"},
      OptionRow{.name = "effects",
                .group = kGrids,
                .setting = "effects",
                .kind = "LIST",
                .member = &B::effects,
                .help = "auto: what the scene calls for; all: also what the plan leaves out, so that "
                        "its decisions can be checked; or a list of effects",
                .shows_default = true},
      OptionRow{.name = "threads",
                .group = kMachine,
                .kind = "N",
                .member = &B::threads,
                .help = "Threads; default all. The result does not depend on it",
                .words = {{"auto", 0}},
                .least = 1,
                .greatest = 0xffffffff,
                .limits = "a number of threads",
                .hint = "auto takes one for each processor"}};
  static_assert(kRows.size() == std::tuple_size_v<decltype(membersOf(BakeOptions()))>,
                "every member of BakeOptions has a row");
  return kRows;
}

const OptionRow* findOption(std::string_view name) {
  const auto rows = optionRows();
  const auto found = std::ranges::find_if(rows, [&](const OptionRow& row) {
    return row.name == name || (!row.former.empty() && row.former == name);
  });
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
