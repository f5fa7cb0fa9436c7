#include "baker/bake/options.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include <fmt/format.h>
#include <unistd.h>

#include "runtime/sh/gaunt.hpp"
#include "runtime/sh/zonal_factors.hpp"

namespace lambent::baker {

namespace {

struct QualityRow {
  const char* name;
  std::size_t rays;
  float error_bound, glossy_error_bound, refine_bound;
  double refine_growth;
  std::size_t refine_added;
  double refine_fans;
  bool fits_glossy;
  float glossy_looseness;
  int exit_bands;  // of exitOrder(), beside five of light
};
constexpr std::array kQualities = {
    QualityRow{"draft", 256, 0.01f, 0.03f, 0.02f, 1.2, 10'000, 0.0, false, 0.0f, 7},
    QualityRow{"standard", 1024, 0.003f, 0.015f, 0.014f, 1.5, 20'000, 0.5, true, 1.5f, 7},
    QualityRow{"high", 4096, 0.001f, 0.005f, 0.007f, 4.0, 60'000, 0.5, true, 3.0f, 9},
};
static_assert(kQualities.back().exit_bands <= sh::kMaxFactoredOrder);

const QualityRow& row(Quality quality) {
  return kQualities[static_cast<std::size_t>(quality)];
}

// All of the text, or nothing.
template <typename T>
bool readAll(std::string_view text, T& value) {
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && at == end;
}

// How far refinement may go, in words.
std::string refineMost(const QualityRow& row) {
  return fmt::format("{} x + {}, fans {} x", row.refine_growth, row.refine_added, row.refine_fans);
}

}  // namespace

std::optional<glm::uvec3> gridSizeFrom(std::string_view text) {
  glm::uvec3 size(0);
  const char* at = text.data();
  const char* const end = at + text.size();
  for (int axis = 0; axis < 3; ++axis) {
    const auto [next, error] = std::from_chars(at, end, size[axis]);
    if (error != std::errc{}) return std::nullopt;
    if (axis == 0 && next == end) return glm::uvec3(size.x);
    if (axis == 2) return next == end ? std::optional(size) : std::nullopt;
    if (next == end || *next != 'x') return std::nullopt;
    at = next + 1;
  }
  return std::nullopt;
}

const char* qualityName(Quality quality) {
  return row(quality).name;
}

std::size_t BakeOptions::effectiveRays() const {
  return rays != 0 ? rays : row(quality).rays;
}

float BakeOptions::effectiveErrorBound() const {
  return error_bound > 0.0f ? error_bound : row(quality).error_bound;
}

float BakeOptions::effectiveGlossyErrorBound() const {
  return error_bound > 0.0f ? error_bound : row(quality).glossy_error_bound;
}

float BakeOptions::glossyLooseness() const {
  return error_bound > 0.0f ? 0.0f : row(quality).glossy_looseness;
}

int BakeOptions::exitOrder() const {
  // No more than visibility is known for beside so many bands of light.
  return bounces == 0
             ? glossy_order
             : std::max(glossy_order, std::min(row(quality).exit_bands, sh::kMaxVisibilityBands + 1 - order));
}

float BakeOptions::effectiveRefineBound() const {
  return refine_bound >= 0.0f ? refine_bound : row(quality).refine_bound;
}

bool BakeOptions::fitsMatte() const {
  return fit.value_or(false);
}

bool BakeOptions::fitsGlossy() const {
  return fit.value_or(row(quality).fits_glossy);
}

double BakeOptions::refineGrowth() const {
  return row(quality).refine_growth;
}

std::size_t BakeOptions::refineAdded() const {
  return row(quality).refine_added;
}

double BakeOptions::refineFans() const {
  return row(quality).refine_fans;
}

std::uint64_t BakeOptions::effectiveMemory() const {
  if (memory_bytes != 0) return memory_bytes;
  const long pages = sysconf(_SC_PHYS_PAGES), page_bytes = sysconf(_SC_PAGESIZE);
  constexpr std::uint64_t kUnknown = std::uint64_t{1} << 31;
  if (pages <= 0 || page_bytes <= 0) return kUnknown;
  return static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page_bytes) / 2;
}

std::map<std::string, std::string> BakeOptions::settings() const {
  return {{"order", std::to_string(order)},
          {"glossyOrder", std::to_string(glossy_order)},
          {"rays", std::to_string(effectiveRays())},
          {"bounces", bounces < 0 ? "auto" : std::to_string(bounces)},
          {"lightSamples", light_samples == 0 ? "auto" : std::to_string(light_samples)},
          {"errorBound", fmt::format("{}", effectiveErrorBound())},
          {"glossyErrorBound", fmt::format("{}", effectiveGlossyErrorBound())},
          {"neighborhoodGrid",
           neighborhood_grid == glm::uvec3(0u)
               ? "auto"
               : fmt::format("{}x{}x{}", neighborhood_grid.x, neighborhood_grid.y, neighborhood_grid.z)},
          {"maxEdge", fmt::format("{}", max_edge_m)},
          {"refineBound", fmt::format("{}", effectiveRefineBound())},
          {"refineMost", refineMost(row(quality))},
          {"fit", fitsMatte()    ? "on"
                  : fitsGlossy() ? "glossy"
                                 : "off"},
          {"volumeGrid", fmt::format("{}x{}x{}", volume_grid.x, volume_grid.y, volume_grid.z)},
          {"effects", effects}};
}

std::optional<BakeOptions> BakeOptions::fromSettings(const std::map<std::string, std::string>& settings) {
  const auto find = [&](const char* name) -> std::string_view {
    const auto found = settings.find(name);
    return found == settings.end() ? std::string_view() : std::string_view(found->second);
  };
  BakeOptions all;
  float glossy_bound = 0.0f;
  const auto readOr = [&](const char* name, const char* word, auto& value) {
    return find(name) == word || readAll(find(name), value);
  };
  const auto readGrid = [&](const char* name, glm::uvec3& grid) {
    const auto read = gridSizeFrom(find(name));
    grid = read.value_or(grid);
    return read.has_value();
  };
  if (!readAll(find("order"), all.order) || !readAll(find("glossyOrder"), all.glossy_order) ||
      !readAll(find("rays"), all.rays) || !readOr("bounces", "auto", all.bounces) ||
      !readOr("lightSamples", "auto", all.light_samples) || !readAll(find("errorBound"), all.error_bound) ||
      !readAll(find("glossyErrorBound"), glossy_bound) || !readAll(find("maxEdge"), all.max_edge_m) ||
      !readAll(find("refineBound"), all.refine_bound) || !readGrid("volumeGrid", all.volume_grid) ||
      !(find("neighborhoodGrid") == "auto" || readGrid("neighborhoodGrid", all.neighborhood_grid)) ||
      !settings.contains("effects"))
    return std::nullopt;
  all.effects = find("effects");
  std::optional<BakeOptions> best;
  int fewest = 0;
  for (const Quality quality : {Quality::Draft, Quality::Standard, Quality::High}) {
    BakeOptions options = all;
    options.quality = quality;
    const QualityRow& usual = row(quality);
    if (find("refineMost") != refineMost(usual)) continue;
    int asked = 4;  // for other than is usual
    if (all.rays == usual.rays) options.rays = 0, --asked;
    if (all.error_bound == usual.error_bound && glossy_bound == usual.glossy_error_bound)
      options.error_bound = 0.0f, --asked;
    if (all.refine_bound == usual.refine_bound) options.refine_bound = -1.0f, --asked;
    const std::string_view fit = find("fit");
    if (fit == (usual.fits_glossy ? "glossy" : "off"))
      --asked;
    else if (fit == "on" || fit == "off")
      options.fit = fit == "on";
    else
      continue;  // "glossy" is not to be had with this quality, other words with none
    if (best && asked >= fewest) continue;
    fewest = asked;
    best = options;
  }
  return best;
}

}  // namespace lambent::baker
