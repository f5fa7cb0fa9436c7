#include "runtime/spec/rotate.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "runtime/spec/numbers.hpp"

namespace lambent::spec {

Result<float> parseDegrees(std::string_view word) {
  if (const std::optional<float> value = parseNumber(word)) return *value;
  return fail("angle \"" + std::string(word) + "\"", "is not a number", "give degrees, such as 30 or -22.5");
}

glm::mat3 lightRotation(float degrees) {
  const double angle = std::fmod(static_cast<double>(degrees), 360.0) * std::numbers::pi / 180.0;
  const float c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  return {{c, 0.0f, -s}, {0.0f, 1.0f, 0.0f}, {s, 0.0f, c}};  // the columns are the images of +X, +Y and +Z
}

}  // namespace lambent::spec
