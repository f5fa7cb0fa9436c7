#include "lambent/sh.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/mat3x3.hpp>

#include "lambent/version.hpp"
#include "runtime/library/convert.hpp"
#include "runtime/sh/image_layout.hpp"
#include "runtime/sh/rotation.hpp"
#include "runtime/sh/window.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/spec/distant_lights.hpp"

namespace lambent {

namespace {

using library::failureOf;
using library::fromGlm;
using library::toGlm;

sh::LightVector roomLight(const LightVector& light) {
  sh::LightVector result{.order = std::clamp(light.order, 1, sh::kMaxOrder)};
  const std::span<glm::vec3> c = result.coefficients();
  for (std::size_t i = 0; i < std::min(c.size(), light.coefficients.size()); ++i)
    c[i] = toGlm(light.coefficients[i]);
  return result;
}

LightVector shownLight(const sh::LightVector& light) {
  LightVector result{.order = light.order, .coefficients = {}};
  for (const glm::vec3& c : light.coefficients()) result.coefficients.push_back(fromGlm(c));
  return result;
}

Expected<void> checkOrder(int order, int most) {
  if (order >= 1 && order <= most) return {};
  return Failure{"order", fmt::format("{} is not in 1..{}", order, most), {}};
}

}  // namespace

const char* version() {
  return LAMBENT_VERSION;
}

Expected<void> evaluateHarmonics(int order, const Vec3& direction, std::span<float> out) {
  if (auto checked = checkOrder(order, sh::kMaxOrder); !checked) return checked;
  if (out.size() < static_cast<std::size_t>(sh::coefficientCount(order)))
    return Failure{
        "out", fmt::format("has room for {} of {} values", out.size(), sh::coefficientCount(order)), {}};
  sh::evaluate(order, toGlm(direction), out);
  return {};
}

Vec3 LightVector::radiance(const Vec3& direction) const {
  return fromGlm(roomLight(*this).evaluate(toGlm(direction)));
}

Vec3 LightVector::irradianceOverPi(const Vec3& normal) const {
  return fromGlm(sh::cosineConvolved(roomLight(*this)).evaluate(toGlm(normal)));
}

LightVector LightVector::withoutRinging() const {
  return shownLight(sh::applyWindow(roomLight(*this), sh::Window::Auto));
}

Expected<LightVector> LightVector::rotated(const std::array<float, 9>& local_from_world) const {
  const auto& m = local_from_world;
  const glm::dmat3 matrix(m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]);
  if (!sh::isRotation(matrix, 1e-4))
    return Failure{"local_from_world", "is no rotation",
                   "give unit rows at right angles, which do not mirror"};
  const Result<glm::dmat3> exact = sh::orthonormalised(matrix);
  if (!exact) return failureOf(exact.error());
  const sh::LightVector light = roomLight(*this);
  return shownLight(sh::Rotation(*exact, light.order).apply(light));
}

Expected<LightVector> projectEquirect(std::span<const Vec3> texels, int width, int height, int order) {
  if (auto checked = checkOrder(order, sh::kMaxOrder); !checked) return checked.failure();
  if (height < 1 || width != 2 * height ||
      texels.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
    return Failure{
        "picture",
        fmt::format("{} x {} with {} texels is not twice as wide as high", width, height, texels.size()),
        {}};
  std::vector<glm::vec3> copied;
  copied.reserve(texels.size());
  for (const Vec3& texel : texels) copied.push_back(toGlm(texel));
  return shownLight(sh::projectImage(order, sh::ImageLayout::LatLong, width, height, copied));
}

Expected<LightVector> lightFrom(const std::vector<std::string>& words, int order) {
  if (auto checked = checkOrder(order, sh::kMaxOrder); !checked) return checked.failure();
  const auto lights = library::distantLights(
      words, {"light", "spheres and discs stand in the scene", "name lights at infinity"});
  if (!lights) return lights.failure();
  const Result<spec::DistantLights> loaded = spec::loadDistantLights(*lights);
  if (!loaded) return failureOf(loaded.error());
  return shownLight(loaded->lightVector().truncated(order));
}

}  // namespace lambent
