#include "baker/bake/picture_budget.hpp"

#include <algorithm>
#include <cmath>

namespace lambent::baker {

namespace {

// So much of the bound is aimed at, since what is measured at a thousand points is a few per cent off.
constexpr double kAim = 0.95;
// A quiet scene has this error with so many rays, which may take this share of the bound; refinement's own
// figure is to that of pictures as 1 to this.
constexpr double kQuietNoise = 0.008, kQuietRays = 256.0, kNoise = 0.65, kRefinement = 1.2;
constexpr std::uint32_t kLeastChosenRays = 128, kMostChosenRays = 16'384, kRaysStep = 16;
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

}  // namespace lambent::baker
