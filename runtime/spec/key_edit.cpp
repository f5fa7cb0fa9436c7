#include "runtime/spec/key_edit.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "runtime/spec/light.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::spec {

namespace {

// Prefixes for each set of lights.
constexpr std::array<std::string_view, 2> kPrefixes = {"key:", "fade-key:"};

tl::unexpected<Error> wrongKeyEdit(std::string_view word, std::string problem) {
  return fail("key light \"" + std::string(word) + "\"", std::move(problem),
              "write key:AZ,EL,TO_AZ,TO_EL,R[,G,B] in degrees, elevations -90..90, and factors of 0 to a "
              "million; or fade-key:... for the lights that are faded to");
}

// Appends the shortest decimal number that reads back as the same float.
void append(std::string& text, float value) {
  std::array<char, 32> digits{};
  const auto [end, code] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  if (code == std::errc{}) text.append(digits.data(), end);
}

float thousandths(float degrees) {
  return std::round(degrees * 1000.0f) / 1000.0f;
}

}  // namespace

Result<KeyEdit> parseKeyEdit(std::string_view word) {
  for (std::size_t set = 0; set < kPrefixes.size(); ++set) {
    if (!word.starts_with(kPrefixes[set])) continue;
    const auto values = parseNumbers(word.substr(kPrefixes[set].size()));
    if (!values) return wrongKeyEdit(word, "is not a list of numbers");
    if (values->size() != 5 && values->size() != 7) return wrongKeyEdit(word, "needs five or seven numbers");
    const std::vector<float>& v = *values;
    if (std::abs(v[1]) > 90.0f || std::abs(v[3]) > 90.0f)
      return wrongKeyEdit(word, "has an elevation outside -90..90");
    if (std::ranges::any_of(std::span(v).subspan(4),
                            [](float factor) { return factor < 0.0f || factor > kMostKeyFactor; }))
      return wrongKeyEdit(word, "has a factor outside 0..1000000");
    return KeyEdit{.set = set,
                   .found = directionFromAzimuthElevation(v[0], v[1]),
                   .towards = directionFromAzimuthElevation(v[2], v[3]),
                   .factor = v.size() == 5 ? glm::vec3(v[4]) : glm::vec3(v[4], v[5], v[6])};
  }
  return wrongKeyEdit(word, "is no edit of a key light");
}

std::string keyEditWord(const KeyEdit& edit) {
  std::string text(kPrefixes[std::min(edit.set, kPrefixes.size() - 1)]);
  for (const glm::vec3& direction : {edit.found, edit.towards}) {
    const AzimuthElevation angles = azimuthElevation(direction);
    append(text, thousandths(angles.azimuth_deg));
    text += ',';
    append(text, thousandths(angles.elevation_deg));
    text += ',';
  }
  append(text, edit.factor.r);
  if (edit.factor.g == edit.factor.r && edit.factor.b == edit.factor.r) return text;
  for (const float factor : {edit.factor.g, edit.factor.b}) {
    text += ',';
    append(text, factor);
  }
  return text;
}

AzimuthElevation azimuthElevation(const glm::vec3& direction) {
  const glm::dvec3 d = glm::normalize(glm::dvec3(direction));
  const bool upright = std::hypot(d.x, d.z) < 1e-7;
  return {upright ? 0.0f : static_cast<float>(glm::degrees(std::atan2(d.x, d.z))),
          static_cast<float>(glm::degrees(std::asin(std::clamp(d.y, -1.0, 1.0))))};
}

}  // namespace lambent::spec
