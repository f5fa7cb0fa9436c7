#include "baker/bake/options.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "runtime/base/process.hpp"
#include "runtime/sh/gaunt.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {

namespace {

// So much of the bound is aimed at, since what is measured at a thousand points is a few per cent off.
constexpr double kAim = 0.95;
// A quiet scene has this error with so many rays, which may take this share of the bound; refinement's own
// figure is to that of pictures as 1 to this.
constexpr double kQuietNoise = 0.008, kQuietRays = 256.0, kNoise = 0.65, kRefinement = 1.2;
constexpr std::uint32_t kLeastChosenRays = 128, kMostChosenRays = 16'384, kRaysStep = 16;
// The parts of the bound that codes, and codes of glossy surfaces, get before more is known. Codes take few:
// half their error costs a bit a weight, half the noise four times the rays.
constexpr float kCodesShare = 0.35f, kGlossyCodesShare = 0.7f;
constexpr double kLeastCodes = 0.25;  // of the bound, even if nothing is left for codes
constexpr float kMostCodes = 0.25f;   // beyond, codes would show bands of colour whatever the mean error is

std::uint32_t wholePackets(double rays) {
  const auto packets =
      static_cast<std::uint32_t>(std::ceil(std::min(rays, double{kMostChosenRays}) / kRaysStep));
  return std::clamp(packets * kRaysStep, kLeastChosenRays, kMostChosenRays);
}

}  // namespace

std::uint32_t raysFor(float picture_bound) {
  const double ratio = kQuietNoise / (kNoise * double{picture_bound});
  return wholePackets(kQuietRays * ratio * ratio);
}

float refineBoundFor(float picture_bound) {
  return std::min(static_cast<float>(kRefinement) * picture_bound, 0.9f);
}

float codesBound(const bundle::PictureError& without_codes, float picture_bound) {
  const double aim = kAim * double{picture_bound}, taken = double{without_codes.all};
  const double left = std::sqrt(std::max(0.0, aim * aim - taken * taken));
  return std::min(static_cast<float>(std::max(left, kLeastCodes * double{picture_bound})), kMostCodes);
}

float glossyCodesBound(float codes_bound) {
  return codes_bound * (kGlossyCodesShare / kCodesShare);
}

std::optional<float> nextCodesBound(float bound, const bundle::PictureError& shown, float picture_bound) {
  constexpr double kCloseEnough = 0.8;
  const bool misses = shown.all > picture_bound;
  if (!misses && double{shown.all} >= kCloseEnough * double{picture_bound}) return std::nullopt;
  if (!(shown.codes > 0.0f)) return std::nullopt;
  bundle::PictureError without = shown;
  without.all = std::sqrt(std::max(0.0f, shown.all * shown.all - shown.codes * shown.codes));
  const float next = std::clamp(bound * codesBound(without, picture_bound) / shown.codes, 0.1f * bound,
                                std::min(kMostCodes, 8.0f * bound));
  // A bound that was already the least, or the most, has nothing to gain.
  constexpr float kSame = 0.05f;
  if (std::abs(next - bound) < kSame * bound) return std::nullopt;
  return next;
}

namespace {

struct QualityRow {
  const char* name;
  std::size_t rays;
  float picture_bound, error_bound, glossy_error_bound, refine_bound;
  double refine_growth;
  std::size_t refine_added;
  bool refines_glossy, fits_glossy;
  float glossy_looseness;
  int exit_bands;  // for exitOrder() with five bands of incident light
  int zstd_level;
};
constexpr std::array kQualities = {
    QualityRow{"draft", 256, 0.05f, 0.01f, 0.03f, 0.04f, 1.2, 10'000, false, false, 0.0f, 5, 12},
    QualityRow{"standard", 1024, 0.03f, 0.003f, 0.015f, 0.02f, 1.5, 20'000, true, true, 1.5f, 7, 19},
    QualityRow{"high", 4096, 0.015f, 0.001f, 0.005f, 0.01f, 4.0, 60'000, true, true, 3.0f, 9, 19},
};
static_assert(kQualities.back().exit_bands <= sh::kMaxFactoredOrder);

const QualityRow& row(Quality quality) {
  return kQualities[static_cast<std::size_t>(quality)];
}

// Describes in words how far refinement may go.
std::string refineMost(const QualityRow& row) {
  return fmt::format("{} x + {}", row.refine_growth, row.refine_added);
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
  if (rays != 0) return rays;
  return picture_bound > 0.0f ? raysFor(picture_bound) : row(quality).rays;
}

float BakeOptions::effectiveErrorBound() const {
  if (error_bound > 0.0f) return error_bound;
  return picture_bound > 0.0f ? kCodesShare * picture_bound : row(quality).error_bound;
}

float BakeOptions::effectivePictureBound() const {
  return picture_bound > 0.0f ? picture_bound : row(quality).picture_bound;
}

float BakeOptions::effectiveGlossyErrorBound() const {
  if (error_bound > 0.0f) return error_bound;
  return picture_bound > 0.0f ? kGlossyCodesShare * picture_bound : row(quality).glossy_error_bound;
}

float BakeOptions::glossyLooseness() const {
  return error_bound > 0.0f ? 0.0f : row(quality).glossy_looseness;
}

int BakeOptions::exitOrder() const {
  // A product of light with n bands and visibility needs order + n - 1 bands of visibility, of which at most
  // kMaxVisibilityBands are known.
  return bounces == 0
             ? glossy_order
             : std::max(glossy_order, std::min(row(quality).exit_bands, sh::kMaxVisibilityBands + 1 - order));
}

float BakeOptions::effectiveRefineBound() const {
  if (refine_bound >= 0.0f) return refine_bound;
  return picture_bound > 0.0f ? refineBoundFor(picture_bound) : row(quality).refine_bound;
}

int BakeOptions::zstdLevel() const {
  return row(quality).zstd_level;
}

bool BakeOptions::fitsDiffuse() const {
  return fit.value_or(true);
}

bool BakeOptions::fitsGlossy() const {
  return fit.value_or(row(quality).fits_glossy);
}

double BakeOptions::refineGrowth() const {
  return row(picture_bound > 0.0f ? Quality::High : quality).refine_growth;
}

std::size_t BakeOptions::refineAdded() const {
  return row(picture_bound > 0.0f ? Quality::High : quality).refine_added;
}

bool BakeOptions::refinesGlossy() const {
  return picture_bound > 0.0f || row(quality).refines_glossy;
}

std::uint64_t BakeOptions::effectiveMemory() const {
  if (memory_bytes != 0) return memory_bytes;
  constexpr std::uint64_t kUnknown = std::uint64_t{1} << 31;
  return machineBytes() == 0 ? kUnknown : machineBytes() / 2;
}

std::uint64_t BakeOptions::memoryLeft(std::uint64_t used, std::size_t diffuse, std::size_t glossy) const {
  const double left = static_cast<double>(effectiveMemory()) - static_cast<double>(used) -
                      static_cast<double>(diffuse) * bytesOfTransfer(false) -
                      static_cast<double>(glossy) * bytesOfTransfer(true);
  return static_cast<std::uint64_t>(std::max(0.0, left));
}

double BakeOptions::bytesOfTransfer(bool glossy) const {
  constexpr double kCopies = 8.0;
  const double vector = static_cast<double>(order) * static_cast<double>(order) * double{sizeof(float)};
  if (!glossy || bounces == 0) return kCopies * vector;
  constexpr double kChannels = 3.0;
  const double outputs = static_cast<double>(glossy_order) * static_cast<double>(glossy_order);
  const double exits = static_cast<double>(exitOrder()) * static_cast<double>(exitOrder());
  return 2.0 * kChannels * (outputs + exits) * vector;
}

std::map<std::string, std::string> BakeOptions::settings() const {
  // These settings follow from the quality, not from the options.
  std::map<std::string, std::string> settings = {
      {"glossyErrorBound", fmt::format("{}", effectiveGlossyErrorBound())},
      {"refineMost", refineMost(row(quality))}};
  for (const OptionRow& option : optionRows())
    if (!option.setting.empty()) settings.emplace(option.setting, option.record(*this));
  return settings;
}

std::optional<BakeOptions> BakeOptions::fromSettings(const std::map<std::string, std::string>& settings) {
  const auto find = [&](std::string_view name) {
    const auto found = settings.find(std::string(name));
    return found == settings.end() ? std::string() : found->second;
  };
  const auto row_of = std::ranges::find(kQualities, find("refineMost"), refineMost);
  if (row_of == kQualities.end()) return std::nullopt;
  BakeOptions options;
  options.quality = static_cast<Quality>(row_of - kQualities.begin());
  for (const OptionRow& option : optionRows()) {
    if (option.setting.empty() || option.setting == "fit") continue;  // "fit" is told with the quality
    if (!settings.contains(std::string(option.setting)) || !option.read(options, find(option.setting)))
      return std::nullopt;
  }
  if (const std::string fit = find("fit"); fit == "on" || fit == "off") options.fit = fit == "on";
  // The options must reproduce these settings, also those that follow from the quality.
  auto wanted = options.settings();
  for (const char* name : {"fit", "glossyErrorBound", "refineMost"}) wanted[name] = find(name);
  const auto wrong = [&](const BakeOptions& tried) {
    int count = 0;
    for (const auto& [name, word] : tried.settings()) count += wanted[name] != word;
    return count;
  };
  // An option that can be left out without changing the settings was not asked for.
  const auto leaveOut = [&](auto member) {
    BakeOptions fewer = options;
    fewer.*member = BakeOptions().*member;
    if (wrong(fewer) <= wrong(options)) options = fewer;
  };
  leaveOut(&BakeOptions::rays), leaveOut(&BakeOptions::error_bound);
  leaveOut(&BakeOptions::refine_bound), leaveOut(&BakeOptions::fit);
  if (wrong(options) > 0) return std::nullopt;
  return options;
}

}  // namespace lambent::baker
