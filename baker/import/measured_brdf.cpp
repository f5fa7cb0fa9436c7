#include "baker/import/measured_brdf.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string_view>

#include <fmt/format.h>
#include <glm/mat3x3.hpp>

#include "baker/import/scene_files.hpp"
#include "runtime/base/atomic_file.hpp"

namespace lambent::baker {
namespace {

constexpr std::size_t kMostWavelengths = 4096;
constexpr const char* kTakeAgain = "take the file from its source again";

// Reads the numbers of a text one after the other; `#` starts a comment that ends with its line.
class Numbers {
 public:
  explicit Numbers(std::string_view text) : text_(text) { skip(); }

  bool ended() const { return at_ == text_.size(); }
  std::size_t line() const { return line_; }
  double next(const char* what) {
    if (ended()) refuse("ends where {} should stand", what);
    double value = 0.0;
    const char* const begin = text_.data() + at_;
    const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), value);
    if (error != std::errc{} || !std::isfinite(value) ||
        (end != text_.data() + text_.size() && !isSpace(*end) && *end != '#'))
      refuse("line {}: {} is not a finite number", line_, what);
    at_ += static_cast<std::size_t>(end - begin);
    skip();
    return value;
  }

 private:
  static bool isSpace(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
  void skip() {
    for (bool comment = false; at_ < text_.size(); ++at_) {
      if (text_[at_] == '#') comment = true;
      if (text_[at_] == '\n') comment = false, ++line_;
      if (!comment && !isSpace(text_[at_])) return;
    }
  }

  std::string_view text_;
  std::size_t at_ = 0, line_ = 1;
};

// This is CIE 1931 colour matching in analytic form: Wyman, Sloan and Shirley 2013, "Simple Analytic
// Approximations to the CIE XYZ Color Matching Functions", multi-lobe fit, equations 4 to 6 (wavelengths in
// nm).
glm::dvec3 colorMatching(double nm) {
  const auto lobe = [nm](double height, double centre, double below, double above) {
    const double t = (nm - centre) * (nm < centre ? below : above);
    return height * std::exp(-0.5 * t * t);
  };
  return {lobe(0.362, 442.0, 0.0624, 0.0374) + lobe(1.056, 599.8, 0.0264, 0.0323) -
              lobe(0.065, 501.1, 0.0490, 0.0382),
          lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322),
          lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725)};
}

// Returns the weight of each wavelength's value in linear Rec.709 under light of equal energy; the spectrum
// is linear between wavelengths. The weights add up to (1, 1, 1), so that white stays white whatever the
// illuminant's own colour.
std::vector<glm::dvec3> colorWeights(const std::vector<double>& nm) {
  // The columns are what X, Y and Z give to red, green and blue (IEC 61966-2-1).
  const glm::dmat3 rgb_from_xyz(3.2404542, -0.9692660, 0.0556434, -1.5371385, 1.8760108, -0.2040259,
                                -0.4985314, 0.0415560, 1.0572252);
  std::vector<glm::dvec3> weights(nm.size(), glm::dvec3(0.0));
  if (nm.size() == 1) return {glm::dvec3(1.0)};
  for (std::size_t i = 0; i + 1 < nm.size(); ++i) {
    const int steps = static_cast<int>(std::clamp(std::ceil(nm[i + 1] - nm[i]), 4.0, 1000.0));
    for (int s = 0; s < steps; ++s) {
      const double share = (s + 0.5) / steps;
      const glm::dvec3 color =
          rgb_from_xyz * colorMatching(std::lerp(nm[i], nm[i + 1], share)) * ((nm[i + 1] - nm[i]) / steps);
      weights[i] += (1.0 - share) * color;
      weights[i + 1] += share * color;
    }
  }
  glm::dvec3 sum(0.0);
  for (const glm::dvec3& weight : weights) sum += weight;
  // All of the visible range gives 107 nm times white; about a hundredth of that is too little to tell a
  // colour.
  if (!(std::min({sum.r, sum.g, sum.b}) > 1.0))
    refuse("its wavelengths leave out a part of the visible range");
  for (glm::dvec3& weight : weights) weight /= sum;
  return weights;
}

std::vector<double> readWavelengths(Numbers& numbers) {
  const double count = numbers.next("the number of wavelengths");
  if (count < 1.0 || count > double{kMostWavelengths} || count != std::floor(count))
    refuse("has {} wavelengths, not 1 to {}", count, kMostWavelengths);
  std::vector<double> nm;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const std::size_t line = numbers.line();
    nm.push_back(numbers.next("a wavelength"));
    if (nm.back() <= 0.0 || (i > 0 && nm[i] <= nm[i - 1])) refuse("line {}: wavelengths do not rise", line);
  }
  return nm;
}

double polar(Numbers& numbers, const char* what) {
  constexpr double kRoundings = 1e-4;
  const std::size_t line = numbers.line();
  const double angle = numbers.next(what);
  if (angle < 0.0 || angle > std::numbers::pi / 2 + kRoundings)
    refuse("line {}: {} is {}, not from 0 to pi/2", line, what, angle);
  return std::min(angle, std::numbers::pi / 2);
}

std::vector<BrdfMeasurement> readMeasurements(Numbers& numbers) {
  const std::vector<double> nm = readWavelengths(numbers);
  const std::vector<glm::dvec3> weights = colorWeights(nm);
  std::vector<BrdfMeasurement> measurements;
  while (!numbers.ended()) {
    BrdfMeasurement m;
    m.theta_i = static_cast<float>(polar(numbers, "theta_i"));
    m.phi_i = static_cast<float>(numbers.next("phi_i"));
    m.theta_o = static_cast<float>(polar(numbers, "theta_s"));
    m.phi_o = static_cast<float>(numbers.next("phi_s"));
    glm::dvec3 color(0.0);
    for (const glm::dvec3& weight : weights) color += weight * numbers.next("a value of the spectrum");
    // Noise, and colours beyond Rec.709, can be negative, but reflected light cannot.
    m.value = glm::vec3(glm::max(color, glm::dvec3(0.0)));
    measurements.push_back(m);
  }
  if (measurements.empty()) refuse("holds no measurement");
  return measurements;
}

}  // namespace

Result<MeasuredBrdf> readMeasuredBrdf(const std::filesystem::path& file) {
  return resultOf(file.string(), "read", kTakeAgain, [&] {
    const std::string text = orThrow(readTextFile(file));
    Numbers numbers(text);
    return MeasuredBrdf{file.filename().string(), readMeasurements(numbers)};
  });
}

}  // namespace lambent::baker
