#include "runtime/spec/light.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <span>
#include <string>

#include <glm/trigonometric.hpp>

#include "runtime/spec/numbers.hpp"

namespace lambent::spec {

namespace {

constexpr std::string_view kForms =
    "give a probe file (.hdr or .exr), constant:R,G,B or sun:AZ,EL,ANGLE,R[,G,B]";
constexpr std::string_view kConstantForm = "write constant:R,G,B with radiances of 0 or more";
constexpr std::string_view kSunForm =
    "write sun:AZ,EL,ANGLE,R[,G,B] in degrees: elevation -90..90, angular radius above 0 up to 180, "
    "radiances of 0 or more";

tl::unexpected<Error> wrong(std::string_view word, std::string problem, std::string_view mend) {
  return fail("light \"" + std::string(word) + "\"", std::move(problem), std::string(mend));
}

std::string lowerExtension(const std::filesystem::path& path) {
  std::string text = path.extension().string();
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// One number stands for all three channels.
std::optional<glm::vec3> parseRadiance(std::span<const float> values) {
  if (values.size() != 1 && values.size() != 3) return std::nullopt;
  if (std::ranges::any_of(values, [](float value) { return value < 0.0f; })) return std::nullopt;
  return values.size() == 1 ? glm::vec3(values[0]) : glm::vec3(values[0], values[1], values[2]);
}

Result<Light> parseConstant(std::string_view word, std::string_view text) {
  const auto values = parseNumbers(text);
  if (!values) return wrong(word, "is not a list of numbers", kConstantForm);
  if (values->size() != 3) return wrong(word, "needs three numbers", kConstantForm);
  const auto colour = parseRadiance(*values);
  if (!colour) return wrong(word, "has a negative radiance", kConstantForm);
  return ConstantLight{*colour};
}

Result<Light> parseSun(std::string_view word, std::string_view text) {
  const auto values = parseNumbers(text);
  if (!values) return wrong(word, "is not a list of numbers", kSunForm);
  if (values->size() != 4 && values->size() != 6) return wrong(word, "needs four or six numbers", kSunForm);
  const float azimuth = (*values)[0], elevation = (*values)[1], angle = (*values)[2];
  if (std::abs(elevation) > 90.0f) return wrong(word, "has an elevation outside -90..90", kSunForm);
  if (angle <= 0.0f || angle > 180.0f) return wrong(word, "has an angular radius outside 0..180", kSunForm);
  const auto colour = parseRadiance(std::span(*values).subspan(3));
  if (!colour) return wrong(word, "has a negative radiance", kSunForm);
  return SunLight{azimuth, elevation, angle, *colour};
}

}  // namespace

Result<Light> parseLight(std::string_view word) {
  constexpr std::string_view kConstant = "constant:", kSun = "sun:", kSphere = "sphere:";
  if (word.empty()) return wrong(word, "is empty", kForms);
  if (word.starts_with(kConstant)) return parseConstant(word, word.substr(kConstant.size()));
  if (word.starts_with(kSun)) return parseSun(word, word.substr(kSun.size()));
  if (word.starts_with(kSphere)) return wrong(word, "sphere lights are not yet supported", kForms);
  const std::filesystem::path file(word);
  const std::string extension = lowerExtension(file);
  if (extension != ".hdr" && extension != ".exr")
    return wrong(word, "is no kind of light known here", kForms);
  return ProbeLight{file, std::nullopt};
}

Result<sh::ImageLayout> parseLightLayout(std::string_view word) {
  for (const auto layout :
       {sh::ImageLayout::LatLong, sh::ImageLayout::AngularMap, sh::ImageLayout::VerticalCross})
    if (word == sh::name(layout)) return layout;
  return fail("light layout \"" + std::string(word) + "\"", "is not known",
              "choose lat-long, angular-map or vertical-cross");
}

glm::vec3 directionFromAzimuthElevation(float azimuth_deg, float elevation_deg) {
  // In double: a sun at azimuth 180 must not stand 1e-7 beside the axis.
  const double azimuth = glm::radians(static_cast<double>(azimuth_deg));
  const double elevation = glm::radians(static_cast<double>(elevation_deg));
  return {static_cast<float>(std::cos(elevation) * std::sin(azimuth)),
          static_cast<float>(std::sin(elevation)),
          static_cast<float>(std::cos(elevation) * std::cos(azimuth))};
}

}  // namespace lambent::spec
