#include "runtime/spec/light.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <string>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "runtime/base/lower_case.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::spec {

namespace {

constexpr std::string_view kForms =
    "give an environment map file (.hdr or .exr), constant:R,G,B, sun:AZ,EL,ANGLE,R[,G,B], "
    "sphere:X,Y,Z,RADIUS,R[,G,B] "
    "or disc:X,Y,Z,NX,NY,NZ,RADIUS,R[,G,B]";
// A Kind is a light that is written as numbers, of which `place` come before its radiance.
struct Kind {
  std::string_view prefix;
  std::size_t place;
  std::string_view count, form;
};
constexpr std::array kKinds = {
    Kind{"constant:", 0, "three", "write constant:R,G,B with radiances of 0 to 1e15"},
    Kind{"sun:", 3, "four or six",
         "write sun:AZ,EL,ANGLE,R[,G,B] in degrees: elevation -90..90, angular radius above 0 up to 180, "
         "radiances of 0 to 1e15"},
    Kind{"sphere:", 4, "five or seven",
         "write sphere:X,Y,Z,RADIUS,R[,G,B] in metres: radius of 0 or more, radiances of 0 to 1e15"},
    Kind{"disc:", 7, "eight or ten",
         "write disc:X,Y,Z,NX,NY,NZ,RADIUS,R[,G,B] in metres: it shines along NX,NY,NZ, which is not 0; "
         "radius of 0 or more, radiances of 0 to 1e15"}};

tl::unexpected<Error> wrongLight(std::string_view word, std::string problem, std::string_view hint) {
  return fail("light \"" + std::string(word) + "\"", std::move(problem), std::string(hint));
}

// Makes the light of a kind from its numbers. Returns what is wrong with them otherwise.
tl::expected<Light, const char*> lightOf(std::size_t kind, const glm::dvec3& position,
                                         std::span<const float> v, const glm::vec3& radiance) {
  if (kind == 0) return ConstantLight{radiance};
  if (kind == 1) {
    if (std::abs(v[1]) > 90.0f) return tl::unexpected<const char*>("has an elevation outside -90..90");
    if (v[2] <= 0.0f || v[2] > 180.0f)
      return tl::unexpected<const char*>("has an angular radius outside 0..180");
    return SunLight{v[0], v[1], v[2], radiance};
  }
  const float radius = v.back();
  if (radius < 0.0f) return tl::unexpected<const char*>("has a negative radius");
  if (kind == 2) return SphereLight{position, radius, radiance};
  // In double precision squares of floats neither overflow nor underflow.
  const glm::dvec3 normal(v[3], v[4], v[5]);
  if (!(glm::length(normal) > 0.0)) return tl::unexpected<const char*>("has a normal of length 0");
  return DiscLight{position, glm::vec3(glm::normalize(normal)), radius, radiance};
}

}  // namespace

Result<Light> parseLight(std::string_view word) {
  if (word.empty()) return wrongLight(word, "is empty", kForms);
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
    const auto& [prefix, place, count, form] = kKinds[kind];
    if (!word.starts_with(prefix)) continue;
    const auto exact = parseNumbers<double>(word.substr(prefix.size()));
    if (!exact) return wrongLight(word, "is not a list of numbers", form);
    const std::vector<float> v(exact->begin(), exact->end());
    const bool grey = v.size() == place + 1 && place > 0;  // one number for all channels, or three
    if (!grey && v.size() != place + 3)
      return wrongLight(word, "needs " + std::string(count) + " numbers", form);
    const std::span<const float> colour = std::span(v).subspan(place);
    if (std::ranges::any_of(colour, [](float value) { return !(value >= 0.0f && value <= kMostRadiance); }))
      return wrongLight(word, "has a radiance outside 0..1e15", form);
    const auto light = lightOf(kind, {(*exact)[0], (*exact)[1], (*exact)[2]}, std::span(v).first(place),
                               grey ? glm::vec3(colour[0]) : glm::vec3(colour[0], colour[1], colour[2]));
    if (!light) return wrongLight(word, light.error(), form);
    return *light;
  }
  const std::filesystem::path file(word);
  const std::string extension = lowerCase(file.extension().string());
  if (extension != ".hdr" && extension != ".exr")
    return wrongLight(word, "is no kind of light known here", kForms);
  return EnvironmentMapLight{file, std::nullopt};
}

Result<std::vector<Light>> parseLights(std::span<const std::string> words, std::string_view layout_word) {
  std::optional<sh::ImageLayout> layout;
  if (!layout_word.empty()) {
    const Result<sh::ImageLayout> parsed = parseLightLayout(layout_word);
    if (!parsed) return failAgain(parsed.error());
    layout = *parsed;
  }
  std::vector<Light> lights;
  for (const std::string& word : words) {
    Result<Light> light = parseLight(word);
    if (!light) return failAgain(std::move(light.error()));
    if (auto* environment_map = std::get_if<EnvironmentMapLight>(&*light)) environment_map->layout = layout;
    lights.push_back(std::move(*light));
  }
  return lights;
}

std::vector<LocalLight> localLights(std::span<const Light> lights, const glm::dvec3& origin) {
  std::vector<LocalLight> out;
  for (const Light& light : lights) {
    if (const auto* sphere = std::get_if<SphereLight>(&light)) out.emplace_back(*sphere);
    if (const auto* disc = std::get_if<DiscLight>(&light)) out.emplace_back(*disc);
  }
  for (LocalLight& light : out) std::visit([&](auto& local) { local.position_ws -= origin; }, light);
  return out;
}

Result<sh::ImageLayout> parseLightLayout(std::string_view word) {
  for (const auto layout :
       {sh::ImageLayout::LatLong, sh::ImageLayout::AngularMap, sh::ImageLayout::VerticalCross})
    if (word == sh::name(layout)) return layout;
  return fail("light layout \"" + std::string(word) + "\"", "is not known",
              "choose lat-long, angular-map or vertical-cross");
}

glm::vec3 directionFromAzimuthElevation(float azimuth_deg, float elevation_deg) {
  // Double precision keeps a sun at azimuth 180 from standing 1e-7 beside the axis.
  const double azimuth = glm::radians(static_cast<double>(azimuth_deg));
  const double elevation = glm::radians(static_cast<double>(elevation_deg));
  return {static_cast<float>(std::cos(elevation) * std::sin(azimuth)),
          static_cast<float>(std::sin(elevation)),
          static_cast<float>(std::cos(elevation) * std::cos(azimuth))};
}

Result<float> parseDegrees(std::string_view word) {
  if (const std::optional<float> value = parseNumber(word)) return *value;
  return fail("angle \"" + std::string(word) + "\"", "is not a number", "give degrees, such as 30 or -22.5");
}

glm::mat3 lightRotation(float degrees) {
  const double angle = std::fmod(static_cast<double>(degrees), 360.0) * std::numbers::pi / 180.0;
  const float c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  return {{c, 0.0f, -s}, {0.0f, 1.0f, 0.0f}, {s, 0.0f, c}};  // the columns are the images of +X, +Y and +Z
}

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
