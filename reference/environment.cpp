#include "reference/environment.hpp"

#include <algorithm>
#include <cmath>

#include "reference/sampler.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::baker::reference {

namespace {

// A texel is divided this finely to sample a direction inside it, because the layouts of runtime/sh map whole
// texels.
constexpr int kFine = 1024;

glm::dvec3 directionAt(const spec::EnvironmentMap& environment_map, double x, double y) {
  const int width = static_cast<int>(environment_map.image.width) * kFine,
            height = static_cast<int>(environment_map.image.height) * kFine;
  return sh::texelDirection(environment_map.layout, width, height,
                            std::clamp(static_cast<int>(x * kFine), 0, width - 1),
                            std::clamp(static_cast<int>(y * kFine), 0, height - 1));
}

// Returns the solid angle per texel area in a unit direction at (x, y) of the picture.
double densityAt(const spec::EnvironmentMap& environment_map, const glm::dvec3& dir, const glm::dvec2& at) {
  constexpr double kFull = std::numbers::pi;
  const double width = environment_map.image.width, height = environment_map.image.height;
  switch (environment_map.layout) {
    case sh::ImageLayout::LatLong:  // sin(polar) dpolar dazimuth
      return std::sqrt(std::max(0.0, 1.0 - dir.y * dir.y)) * (kFull / height) * (2.0 * kFull / width);
    case sh::ImageLayout::AngularMap: {  // sin(pi r) pi dr dphi over r dr dphi
      const double u = 2.0 * at.x / width - 1.0, v = 2.0 * at.y / height - 1.0;
      const double r = std::sqrt(u * u + v * v), side = std::sqrt(std::max(0.0, 1.0 - dir.z * dir.z));
      return (r > 1e-9 ? kFull * side / r : kFull * kFull) * (2.0 / width) * (2.0 / height);
    }
    // This is (1 + u² + v²)^(-3/2) du dv, with u and v over a face of the cube.
    case sh::ImageLayout::VerticalCross: {
      const glm::dvec3 size = glm::abs(dir);
      const double towards = std::max({size.x, size.y, size.z});
      return towards * towards * towards * (6.0 / width) * (6.0 / width);
    }
  }
  return 0.0;
}

double brightness(const glm::vec3& radiance) {
  return std::max(0.0, (double{radiance.r} + double{radiance.g} + double{radiance.b}) / 3.0);
}

// Returns the last entry at or below u, and the fraction of the way from it to the next.
std::pair<std::size_t, double> place(const float* first, std::size_t count, float u) {
  const float* above = std::upper_bound(first + 1, first + count, u);
  const auto at = static_cast<std::size_t>(above - first) - 1;
  const double width = double{first[at + 1]} - double{first[at]};
  return {at, width > 0.0 ? std::min((double{u} - double{first[at]}) / width, 0x1.fffffep-1) : 0.5};
}

}  // namespace

Environment::Environment(spec::DistantLights lights, float turn_degrees, int band_limit)
    : lights_(std::move(lights)),
      world_from_light_(spec::lightRotation(turn_degrees)),
      band_limit_(band_limit) {
  vector_ = spec::turned(lights_.lightVector(), turn_degrees);
  if (band_limit > 0) vector_ = vector_.truncated(band_limit);
  for (const spec::Disc& disc : lights_.discs) {
    const double half = std::sin(0.5 * double{disc.radius_rad});
    cones_.push_back(
        {.frame = frameAbout(glm::normalize(disc.direction)), .cap = static_cast<float>(2.0 * half * half)});
    if (disc.radiance != glm::vec3(0.0f)) dark_ = false;
  }
  if (lights_.constant != glm::vec3(0.0f)) dark_ = false;
  // Texels that do not wholly show a direction hold whatever the file has there.
  for (spec::EnvironmentMap& environment_map : lights_.environment_maps)
    for (std::size_t i = 0; i < environment_map.image.texels.size(); ++i) {
      const int width = static_cast<int>(environment_map.image.width),
                height = static_cast<int>(environment_map.image.height);
      const int x = static_cast<int>(i % environment_map.image.width),
                y = static_cast<int>(i / environment_map.image.width);
      if (sh::texelSolidAngle(environment_map.layout, width, height, x, y) <= 0.0)
        environment_map.image.texels[i] = glm::vec3(0.0f);
      if (environment_map.image.texels[i] != glm::vec3(0.0f)) dark_ = false;
    }
  if (band_limit > 0) return;

  for (std::size_t i = 0; i < lights_.environment_maps.size(); ++i) addEnvironmentMap(i);
  for (std::size_t i = 0; i < lights_.discs.size(); ++i)
    parts_.push_back({.probability = brightness(lights_.discs[i].radiance) * double{cones_[i].cap} * 2.0 *
                                     std::numbers::pi,
                      .disc = i,
                      .is_disc = true});
  std::erase_if(parts_, [](const Part& part) { return !(part.probability > 0.0); });
  double sum = 0.0;
  for (const Part& part : parts_) sum += part.probability;
  for (Part& part : parts_) part.probability /= sum;
}

void Environment::addEnvironmentMap(std::size_t index) {
  const spec::EnvironmentMap& environment_map = lights_.environment_maps[index];
  const std::size_t width = environment_map.image.width, height = environment_map.image.height;
  Distribution out;
  out.columns.assign((width + 1) * height, 0.0f);
  std::vector<double> rows = {0.0}, row(width + 1, 0.0);
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const double angle =
          sh::texelSolidAngle(environment_map.layout, static_cast<int>(width), static_cast<int>(height),
                              static_cast<int>(x), static_cast<int>(y));
      row[x + 1] = row[x] + angle * brightness(environment_map.image.texels[y * width + x]);
    }
    rows.push_back(rows.back() + row[width]);
    for (std::size_t x = 1; x <= width; ++x)
      out.columns[y * (width + 1) + x] = row[width] > 0.0 ? static_cast<float>(row[x] / row[width]) : 0.0f;
  }
  const double power = rows[height];
  for (const double value : rows) out.rows.push_back(power > 0.0 ? static_cast<float>(value / power) : 0.0f);
  // Probabilities are taken from the rounded sums, because these are used for sampling.
  for (std::size_t i = 0; i < width * height; ++i) {
    const std::size_t y = i / width, column = y * (width + 1) + i % width;
    out.texels.emplace_back(
        environment_map.image.texels[i],
        (out.rows[y + 1] - out.rows[y]) * (out.columns[column + 1] - out.columns[column]));
  }
  distributions_.push_back(std::move(out));
  parts_.push_back({.probability = power, .environment_map = index});
}

Environment::Look Environment::lookAtEnvironmentMap(std::size_t index, const glm::dvec3& dir) const {
  const spec::EnvironmentMap& environment_map = lights_.environment_maps[index];
  const std::uint32_t width = environment_map.image.width, height = environment_map.image.height;
  const glm::dvec2 at =
      sh::imageCoordinates(environment_map.layout, static_cast<int>(width), static_cast<int>(height), dir);
  const auto x = static_cast<std::size_t>(std::clamp(at.x, 0.0, width - 1.0));
  const auto y = static_cast<std::size_t>(std::clamp(at.y, 0.0, height - 1.0));
  const glm::vec4& texel = distributions_[index].texels[y * width + x];
  const double density = densityAt(environment_map, dir, at);
  return {glm::vec3(texel), density > 0.0 ? static_cast<float>(double{texel.w} / density) : 0.0f};
}

bool Environment::inside(const Cone& cone, const glm::vec3& dir) const {
  // Chords are compared, because the cosine of a small disc's radius has no significant digits left.
  if (cone.cap > 1.0f) return glm::dot(dir, cone.frame[2]) >= 1.0f - cone.cap;
  const glm::vec3 away = dir - cone.frame[2];
  return glm::dot(away, away) <= 2.0f * cone.cap;
}

Environment::Look Environment::look(const glm::vec3& dir) const {
  if (band_limit_ > 0) return {vector_.evaluate(dir), 0.0f};
  Look sum{lights_.constant, 0.0f};
  if (parts_.empty()) return sum;
  const glm::vec3 local = dir * world_from_light_;  // the transpose is the inverse
  for (const Part& part : parts_) {
    Look one;
    if (!part.is_disc)
      one = lookAtEnvironmentMap(part.environment_map, glm::dvec3(local));
    else if (inside(cones_[part.disc], local))
      one = {lights_.discs[part.disc].radiance, 1.0f / (2.0f * kPi * cones_[part.disc].cap)};
    sum.radiance += one.radiance;
    sum.pdf += static_cast<float>(part.probability) * one.pdf;
  }
  return sum;
}

glm::vec3 Environment::shown(const glm::vec3& dir, float pixel_angle_rad) const {
  const glm::vec3 local = glm::normalize(dir * world_from_light_);
  glm::vec3 sum = lights_.constant;
  for (const spec::Disc& disc : lights_.discs) {
    const float angle =
        std::atan2(glm::length(glm::cross(local, disc.direction)), glm::dot(local, disc.direction));
    sum += std::clamp((disc.radius_rad - angle) / pixel_angle_rad + 0.5f, 0.0f, 1.0f) * disc.radiance;
  }
  for (const spec::EnvironmentMap& environment_map : lights_.environment_maps)
    sum += spec::radiance(environment_map, local);
  return sum;
}

glm::vec3 Environment::sample(float choice, const glm::vec2& u) const {
  std::size_t chosen = 0;
  for (double left = choice; chosen + 1 < parts_.size() && left >= parts_[chosen].probability; ++chosen)
    left -= parts_[chosen].probability;
  const Part& part = parts_[chosen];
  if (part.is_disc)
    return glm::normalize(world_from_light_ *
                          (cones_[part.disc].frame * coneDirection(u, cones_[part.disc].cap)));
  const spec::EnvironmentMap& environment_map = lights_.environment_maps[part.environment_map];
  const Distribution& d = distributions_[part.environment_map];
  const std::size_t width = environment_map.image.width;
  const auto [y, below] = place(d.rows.data(), d.rows.size(), u.y);
  const auto [x, right] = place(&d.columns[y * (width + 1)], width + 1, u.x);
  const glm::dvec3 local =
      directionAt(environment_map, static_cast<double>(x) + right, static_cast<double>(y) + below);
  return local == glm::dvec3(0.0) ? glm::vec3(0.0f) : glm::normalize(world_from_light_ * glm::vec3(local));
}

}  // namespace lambent::baker::reference
