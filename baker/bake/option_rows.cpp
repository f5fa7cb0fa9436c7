#include "baker/bake/option_rows.hpp"

#include <algorithm>
#include <array>
#include <tuple>
#include <type_traits>

#include <fmt/format.h>

#include "baker/bake/typed_option.hpp"
#include "baker/effects/effect_list.hpp"
#include "baker/effects/neighborhood/grid_placement.hpp"
#include "baker/plan/local_light.hpp"

namespace lambent::baker {

namespace {

using namespace typed_options;

// ---- the table

using B = BakeOptions;

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

Result<void> checkEffects(const BakeOptions& o) {
  if (const auto known = effectsNamed(o.effects); !known) return failAgain(known.error());
  return {};
}

constexpr std::tuple kRows{
    TypedRow<Quality>{
        .name = "quality",
        .group = kAccuracy,
        .setting = "",
        .kind = "draft|standard|high",
        .member = &B::quality,
        .help = "Rays, refinement and error bounds together; default standard",
        .words = {{{"draft", Quality::Draft}, {"standard", Quality::Standard}, {"high", Quality::High}}}},
    TypedRow<int>{.name = "order",
                  .group = kAccuracy,
                  .setting = "order",
                  .kind = "N",
                  .member = &B::order,
                  .help = "Bands of spherical harmonics, 1..8; order² coefficients",
                  .limits = Limits<int>{.least = 1, .greatest = 8, .hint = "5 is the default"}},
    TypedRow<int>{.name = "glossy-order",
                  .group = kAccuracy,
                  .setting = "glossyOrder",
                  .kind = "N",
                  .member = &B::glossy_order,
                  .help = "Bands of the light that glossy surfaces reflect, 4..6",
                  .limits = Limits<int>{.least = 4, .greatest = 6, .hint = "5 is the default"}},
    TypedRow<std::uint32_t>{
        .name = "rays",
        .group = kAccuracy,
        .setting = "rays",
        .kind = "N",
        .member = &B::rays,
        .help = "Rays per sample over its hemisphere; default {} by quality",
        .words = {{{"auto", 0}}},
        .limits =
            Limits<std::uint32_t>{
                .least = 128, .greatest = 1u << 20, .hint = "leave it out to take what --quality stands for"},
        .record = &recordRays,
        .help_values = {&recordRays}},
    TypedRow<int>{
        .name = "bounces",
        .group = kAccuracy,
        .setting = "bounces",
        .kind = "N",
        .member = &B::bounces,
        .help = "Interreflections between surfaces, 0..64; 0: direct light with shadows only, and single "
                "scattering in volumes, which else scatter as often as they do; default: until what is left "
                "out is far under the error bound",
        .words = {{{"auto", -1}}},
        .limits = Limits<int>{.least = 0,
                              .greatest = B::kMostBounces,
                              .hint = "leave it out to bake as many as the error bound asks for"}},
    TypedRow<std::uint64_t>{
        .name = "max-memory",
        .group = kMachine,
        .setting = "",
        .kind = "BYTES",
        .member = &B::memory_bytes,
        .help =
            "The memory that the bake takes if it can, in bytes or like 4GB; default half of the machine's. "
            "What passes cannot keep in it is computed again: slower, the same result",
        .words = {{{"auto", 0}}},
        .limits = Limits<std::uint64_t>{.least = 1u << 16,
                                        .greatest = kMost<std::uint64_t>,
                                        .kind = "a size of 64KB or more",
                                        .hint = "give bytes or a unit, as 4GB"}},
    TypedRow<float>{
        .name = "error",
        .group = kAccuracy,
        .setting = "pictureBound",
        .kind = "E",
        .member = &B::picture_bound,
        .help = "Bound on the error of pictures of surfaces, relative RMS over real lights, by rays, "
                "interpolation and codes together. The bake chooses --rays, --refine and --codes, as far as "
                "they are not given, and says what it reached",
        .words = {{{"none", 0.0f}}},
        .limits = Limits<float>{.least = 0.0f,
                                .greatest = 1.0f,
                                .open = true,
                                .kind = "a share between 0 and 1",
                                .hint = "write 2 % as 0.02 or 2%"},
        .share = true},
    TypedRow<float>{
        .name = "codes",
        .group = kAccuracy,
        .setting = "errorBound",
        .kind = "E",
        .member = &B::error_bound,
        .help = "Bound on the error of codes alone, relative RMS of shaded radiance; default {} by quality, "
                "of glossy surfaces {}",
        .words = {{{"auto", 0.0f}}},
        .limits = Limits<float>{.least = 0.0f,
                                .greatest = 1.0f,
                                .open = true,
                                .kind = "a share between 0 and 1",
                                .hint = "write 0.3 % as 0.003 or 0.3%"},
        .record = &recordCodes,
        .help_values = {&recordCodes, &recordGlossyError},
        .share = true},
    TypedRow<float>{
        .name = "max-edge",
        .group = kVertices,
        .setting = "maxEdge",
        .kind = "M",
        .member = &B::max_edge_m,
        .help = "Split edges longer than this (scene units), so that large faces catch shadows",
        .limits = Limits<float>{.least = 0.0f,
                                .greatest = kMost<float>,
                                .kind = "a length",
                                .hint = "give a positive number in the scene's units, or leave it out"}},
    TypedRow<float>{
        .name = "refine",
        .group = kVertices,
        .setting = "refineBound",
        .kind = "E|auto|off",
        .member = &B::refine_bound,
        .help =
            "Split edges where shadows change, until interpolation errs by less than E, relative RMS; auto "
            "(default): {} by quality; off: keep the vertices as they are",
        .words = {{{"auto", -1.0f}, {"off", 0.0f}}},
        .limits = Limits<float>{.least = 0.0f,
                                .greatest = 1.0f,
                                .open = true,
                                .kind = "a share between 0 and 1",
                                .hint = "write 2 % as 0.02 or 2%; auto takes what --quality stands for"},
        .record = &recordRefine,
        .help_values = {&recordRefine},
        .share = true},
    TypedRow<std::optional<bool>>{
        .name = "fit",
        .group = kVertices,
        .setting = "fit",
        .kind = "auto|on|off",
        .member = &B::fit,
        .help =
            "Fit light at vertices to what rays from inside the faces see, so that interpolation shows "
            "faces best: on, off (what the vertices see) or auto (default): on, but not on glossy surfaces "
            "of drafts",
        .words = {{{"auto", std::nullopt}, {"on", true}, {"off", false}}},
        .record = &recordFit},
    TypedRow<int>{
        .name = "light-probes",
        .group = kGrids,
        .setting = "lightSamples",
        .kind = "N|auto",
        .member = &B::light_probes,
        .help = "Points of each cell at which light from outside is sampled, 1..32; 1 for a group: light at "
                "infinity. auto (default): by how near light comes, shared out over the group",
        .words = {{{"auto", 0}}},
        .limits = Limits<int>{.least = 1,
                              .greatest = static_cast<int>(kMostLightProbes),
                              .hint = "auto chooses by how near light comes"},
        .former = "light-samples"},
    TypedRow<glm::uvec3>{
        .name = "neighborhood-grid",
        .group = kGrids,
        .setting = "neighborhoodGrid",
        .kind = "XxYxZ",
        .member = &B::neighborhood_grid,
        .help =
            "Points of neighborhood grids along their longest, middle and shortest side, 2..256 each; auto "
            "(default): 64x64x8 where receivers are on one side only, else 32x32x32; for bodies that the "
            "scene does not name a quarter of that",
        .words = {{{"auto", glm::uvec3(0u)}}},
        .limits = Limits<glm::uvec3>{.least = 2, .greatest = kMostGridPoints, .hint = "64x64x8 is usual"}},
    TypedRow<glm::uvec3>{
        .name = "volume-grid",
        .group = kGrids,
        .setting = "volumeGrid",
        .kind = "N|XxYxZ",
        .member = &B::volume_grid,
        .help = "Voxels of the grid that a volume's transfer is baked on, 1..256 along each axis; default 32",
        .limits = Limits<glm::uvec3>{.least = 1, .greatest = 256, .hint = "32 is the default"}},
    TypedRow<std::string>{.name = "effects",
                          .group = kGrids,
                          .setting = "effects",
                          .kind = "LIST",
                          .member = &B::effects,
                          .help =
                              "auto: what the scene calls for; all: also what the plan leaves out, so that "
                              "its decisions can be checked; or a list of effects",
                          .check = &checkEffects},
    TypedRow<unsigned>{.name = "threads",
                       .group = kMachine,
                       .setting = "",
                       .kind = "N",
                       .member = &B::threads,
                       .help = "Threads; default all. The result does not depend on it",
                       .words = {{{"auto", 0}}},
                       .limits = Limits<unsigned>{.least = 1,
                                                  .greatest = kMost<unsigned>,
                                                  .kind = "a number of threads",
                                                  .hint = "auto takes one for each processor"}}};

// A member of BakeOptions without a row does not compile, since it changes how many names this needs.
[[maybe_unused]] auto membersOf(const BakeOptions& options) {
  const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] = options;
  return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p);
}
static_assert(std::tuple_size_v<decltype(membersOf(BakeOptions()))> == std::tuple_size_v<decltype(kRows)>,
              "every member of BakeOptions has a row");

// ---- rows without their types

template <std::size_t I>
bool outsideOf(const BakeOptions& options) {
  const auto& row = std::get<I>(kRows);
  if constexpr (kHasLimits<std::remove_cvref_t<decltype(options.*row.member)>>)
    return outside(row, options.*row.member).has_value();
  else
    return false;
}

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
  BakeOptions tried = options;
  auto& value = tried.*row.member;
  // A number is no other word for what a word stands for: 0 does not mean "auto".
  const bool named = std::ranges::any_of(row.words, [&](const auto& w) { return w.word == word; });
  const bool good = readValue(row, word, value) && (named || !outsideOf<I>(tried));
  if (!good)
    return fail(fmt::format("--{}", row.name),
                word.empty() ? "is empty" : fmt::format("{} {}", word, notOfItsKind(row)),
                row.limits && !row.limits->hint.empty() ? std::string(row.limits->hint)
                                                        : fmt::format("give {}", row.kind));
  if (auto checked = checkMore(row, tried); !checked) return checked;
  options = std::move(tried);
  return {};
}

template <std::size_t I>
Result<void> checkValue(const BakeOptions& options) {
  const auto& row = std::get<I>(kRows);
  const auto& value = options.*row.member;
  const bool named =
      std::ranges::any_of(row.words, [&](const auto& w) { return !w.word.empty() && w.value == value; });
  if (!named && outsideOf<I>(options))
    return fail(fmt::format("--{}", row.name), fmt::format("{} {}", textOf(row, value), notOfItsKind(row)),
                std::string(row.limits->hint));
  return checkMore(row, options);
}

// Lists what the options of each quality come to: "256, 1024 or 4096".
std::string byQuality(std::string (*value)(const BakeOptions&)) {
  std::string text;
  for (const Quality quality : {Quality::Draft, Quality::Standard, Quality::High})
    text += fmt::format("{}{}",
                        quality == Quality::Draft  ? ""
                        : quality == Quality::High ? " or "
                                                   : ", ",
                        value({.quality = quality}));
  return text;
}

template <std::size_t I>
std::string helpOf() {
  const auto& row = std::get<I>(kRows);
  std::string help(row.help);
  for (const auto value : row.help_values)
    if (value) help.replace(help.find("{}"), 2, byQuality(value));
  return help;
}

template <std::size_t I>
OptionRow optionRow() {
  const auto& row = std::get<I>(kRows);
  using T = std::remove_cvref_t<decltype(BakeOptions().*row.member)>;
  OptionRow out{.name = row.name,
                .group = row.group,
                .setting = row.setting,
                .kind = row.kind,
                .help = helpOf<I>(),
                .former = row.former};
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
