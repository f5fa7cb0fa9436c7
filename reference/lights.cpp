#include "reference/lights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "reference/sampler.hpp"
#include "runtime/sh/local_light.hpp"
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

namespace {

// Returns the mean over the triangle from seven points. It is never 0, because a texture may emit only
// between them.
double meanBrightness(const Surfaces& surfaces, std::uint32_t surface, std::uint32_t triangle) {
  constexpr glm::vec2 kPlaces[] = {{1.0f / 3.0f, 1.0f / 3.0f},
                                   {0.05f, 0.05f},
                                   {0.9f, 0.05f},
                                   {0.05f, 0.9f},
                                   {0.45f, 0.1f},
                                   {0.1f, 0.45f},
                                   {0.45f, 0.45f}};
  const auto mean = [](const glm::vec3& c) { return (double{c.r} + double{c.g} + double{c.b}) / 3.0; };
  double sum = 0.0;
  for (const glm::vec2& at : kPlaces)
    sum += mean(surfaces.emittedAt({.surface = surface, .triangle = triangle, .u = at.x, .v = at.y}));
  return sum / std::size(kPlaces) + 0.02 * mean(surfaces.surfaces()[surface].material.emissive);
}

}  // namespace

EmissiveTriangles::EmissiveTriangles(const Surfaces& surfaces) : surfaces_(surfaces) {
  std::vector<double> areas;
  cumulated_ = {0.0};
  for (std::uint32_t s = 0; s < surfaces.surfaces().size(); ++s) {
    const Surface& surface = surfaces.surfaces()[s];
    const gltf::Material& material = surface.material;
    if (material.unlit || material.emissive == glm::vec3(0.0f) ||
        material.alpha_mode == gltf::AlphaMode::Blend)
      continue;
    for (std::uint32_t t = surface.first_triangle; t < surface.first_triangle + surface.triangle_count; ++t) {
      const double area = 0.5 * glm::length(surfaces.areaVector(t));
      const double power = area * meanBrightness(surfaces, s, t) * (material.double_sided ? 2.0 : 1.0);
      if (!(power > 0.0)) continue;
      triangles_.push_back(t);
      surface_of_.push_back(s);
      areas.push_back(area);
      cumulated_.push_back(cumulated_.back() + power);
    }
  }
  if (triangles_.empty()) return;
  const double sum = cumulated_.back();
  for (double& value : cumulated_) value /= sum;
  per_area_.assign(surfaces.triangles().size(), 0.0f);
  for (std::size_t i = 0; i < triangles_.size(); ++i)
    per_area_[triangles_[i]] = static_cast<float>((cumulated_[i + 1] - cumulated_[i]) / areas[i]);
}

EmissiveTriangles::Sample EmissiveTriangles::sample(float choice, const glm::vec2& u) const {
  const auto above = std::upper_bound(cumulated_.begin() + 1, cumulated_.end() - 1, double{choice});
  const auto i = static_cast<std::size_t>(above - cumulated_.begin()) - 1;
  const glm::vec2 at = trianglePoint(u);
  Sample out;
  out.hit = {.surface = surface_of_[i], .triangle = triangles_[i], .u = at.x, .v = at.y};
  const glm::uvec3 t = surfaces_.triangles()[triangles_[i]];
  const auto& p = surfaces_.positions();
  out.position = (1.0f - at.x - at.y) * p[t.x] + at.x * p[t.y] + at.y * p[t.z];
  out.normal = glm::vec3(glm::normalize(surfaces_.areaVector(triangles_[i])));
  out.double_sided = surfaces_.surfaces()[surface_of_[i]].material.double_sided;
  out.per_area = per_area_[triangles_[i]];
  return out;
}

float EmissiveTriangles::perArea(const Hit& hit) const {
  return per_area_.empty() ? 0.0f : per_area_[hit.triangle];
}

std::vector<PunctualLight> punctualLights(const Scene& scene) {
  std::vector<PunctualLight> out;
  const std::vector<glm::mat4> world = gltf::worldTransforms(scene.nodes);
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    if (scene.nodes[n].light < 0) continue;
    PunctualLight light{.light = scene.lights[static_cast<std::size_t>(scene.nodes[n].light)],
                        .position = glm::vec3(world[n][3])};
    const glm::vec3 along = -glm::vec3(world[n][2]);
    if (glm::length(along) > 0.0f) light.along = glm::normalize(along);
    out.push_back(std::move(light));
  }
  return out;
}

std::optional<Beam> beamAt(const PunctualLight& light, const glm::vec3& position) {
  const gltf::Light& l = light.light;
  Beam beam{.distance = std::numeric_limits<float>::infinity(), .irradiance = l.intensity * l.color};
  if (l.type == gltf::Light::Type::Directional) {
    beam.to_light = -light.along;
    return beam;
  }
  const glm::vec3 to = light.position - position;
  beam.distance = glm::length(to);
  if (!(beam.distance > 0.0f)) return std::nullopt;
  beam.to_light = to / beam.distance;
  const double distance = beam.distance;
  auto fade = static_cast<float>(sh::rangeFade(distance, l.range_m) / (distance * distance));
  if (l.type == gltf::Light::Type::Spot)
    fade *= static_cast<float>(
        sh::coneFade(glm::dot(light.along, -beam.to_light), l.inner_cone_rad, l.outer_cone_rad));
  if (!(fade > 0.0f)) return std::nullopt;
  beam.irradiance *= fade;
  return beam;
}

namespace {

// Returns 1 - cos of the half angle of a sphere, without cancellation if it is far away.
double capOf(double radius, double distance) {
  const double sine = radius / distance, sine2 = sine * sine;
  return sine2 / (1.0 + std::sqrt(std::max(0.0, 1.0 - sine2)));
}

std::optional<WayToLight> sample(const spec::SphereLight& light, const glm::vec3& point, const glm::vec2& u) {
  const glm::dvec3 to = light.position_ws - glm::dvec3(point);
  const double distance = glm::length(to), radius = double{light.radius_m};
  if (!(radius > 0.0) || distance <= radius) return std::nullopt;
  const auto cap = static_cast<float>(capOf(radius, distance));
  if (!(cap > 0.0f)) return std::nullopt;
  const glm::vec3 local = coneDirection(u, cap);
  // The distance is that of the centre along the ray, minus half the chord.
  const double aside2 =
      distance * distance * (double{local.x} * double{local.x} + double{local.y} * double{local.y});
  const double near = distance * double{local.z} - std::sqrt(std::max(0.0, radius * radius - aside2));
  return WayToLight{.dir = glm::normalize(frameAbout(glm::vec3(to / distance)) * local),
                    .distance = static_cast<float>(near),
                    .radiance = light.radiance,
                    .pdf = 1.0f / (2.0f * kPi * cap)};
}

std::optional<WayToLight> look(const spec::SphereLight& light, const glm::vec3& point, const glm::vec3& dir) {
  const glm::dvec3 to = light.position_ws - glm::dvec3(point), along(dir);
  const double radius = double{light.radius_m}, distance = glm::length(to), middle = glm::dot(to, along);
  const glm::dvec3 aside = to - middle * along;
  const double half2 = radius * radius - glm::dot(aside, aside);
  if (!(radius > 0.0) || half2 < 0.0) return std::nullopt;
  WayToLight way{.dir = dir, .radiance = light.radiance};
  if (distance <= radius) {
    way.distance = static_cast<float>(middle + std::sqrt(half2));
    return way;
  }
  if (middle <= 0.0) return std::nullopt;
  way.distance = static_cast<float>(middle - std::sqrt(half2));
  way.pdf = static_cast<float>(1.0 / (2.0 * std::numbers::pi * capOf(radius, distance)));
  return way;
}

// Converts density per area to solid angle. Returns nothing in the disc's plane and behind it.
std::optional<WayToLight> towards(const spec::DiscLight& light, const glm::dvec3& to) {
  const double distance = glm::length(to), radius = double{light.radius_m};
  if (!(distance > 0.0)) return std::nullopt;
  const glm::dvec3 dir = to / distance;
  const double facing = -glm::dot(glm::dvec3(light.normal_ws), dir);
  const auto pdf = static_cast<float>(distance * distance / (std::numbers::pi * radius * radius * facing));
  if (!(facing > 0.0) || !(pdf > 0.0f) || !std::isfinite(pdf)) return std::nullopt;
  return WayToLight{.dir = glm::vec3(dir),
                    .distance = static_cast<float>(distance),
                    .radiance = light.radiance,
                    .pdf = pdf};
}

std::optional<WayToLight> sample(const spec::DiscLight& light, const glm::vec3& point, const glm::vec2& u) {
  if (!(light.radius_m > 0.0f)) return std::nullopt;
  // Cosine-distributed directions, projected onto the plane, are uniform over a disc.
  const glm::vec3 on = cosineDirection(u);
  const glm::vec3 offset = light.radius_m * (frameAbout(light.normal_ws) * glm::vec3(on.x, on.y, 0.0f));
  return towards(light, light.position_ws + glm::dvec3(offset) - glm::dvec3(point));
}

std::optional<WayToLight> look(const spec::DiscLight& light, const glm::vec3& point, const glm::vec3& dir) {
  const glm::dvec3 to = light.position_ws - glm::dvec3(point), along(dir), normal(light.normal_ws);
  const double facing = -glm::dot(normal, along), height = -glm::dot(normal, to);
  if (!(light.radius_m > 0.0f) || !(facing > 0.0) || !(height > 0.0)) return std::nullopt;
  const glm::dvec3 there = height / facing * along;
  const double radius = double{light.radius_m};
  const glm::dvec3 aside = there - to;
  if (glm::dot(aside, aside) > radius * radius) return std::nullopt;
  return towards(light, there);
}

sh::LightVector truncated(const spec::SphereLight& light, int order, const glm::dvec3& point) {
  return sh::sphereLight(order, light.position_ws - point, double{light.radius_m}, light.radiance);
}

sh::LightVector truncated(const spec::DiscLight& light, int order, const glm::dvec3& point) {
  return sh::discAreaLight(order, light.position_ws - point, glm::dvec3(light.normal_ws),
                           double{light.radius_m}, light.radiance);
}

}  // namespace

std::optional<WayToLight> sampleShape(const spec::LocalLight& light, const glm::vec3& point,
                                      const glm::vec2& u) {
  return std::visit([&](const auto& shape) { return sample(shape, point, u); }, light);
}

std::optional<WayToLight> lookAtShape(const spec::LocalLight& light, const glm::vec3& point,
                                      const glm::vec3& dir) {
  return std::visit([&](const auto& shape) { return look(shape, point, dir); }, light);
}

sh::LightVector shapeLight(const spec::LocalLight& light, int order, const glm::vec3& point) {
  return std::visit([&](const auto& shape) { return truncated(shape, order, glm::dvec3(point)); }, light);
}

namespace {

// Combines the lights, each times its factor, and those in `more`, which may be null.
spec::DistantLights together(const std::vector<spec::DistantLights>& each, const std::vector<float>& factors,
                             const spec::DistantLights* more) {
  spec::DistantLights all;
  const auto add = [&](const spec::DistantLights& one, float factor) {
    all.constant += factor * one.constant;
    for (spec::Disc disc : one.discs) {
      disc.radiance *= factor;
      all.discs.push_back(disc);
    }
    for (const spec::EnvironmentMap& environment_map : one.environment_maps) {
      all.environment_maps.push_back(environment_map);
      if (factor != 1.0f)
        for (glm::vec3& texel : all.environment_maps.back().image.texels) texel *= factor;
    }
  };
  for (std::size_t i = 0; i < each.size(); ++i) {
    add(each[i], factors[i]);
    all.notices.insert(all.notices.end(), each[i].notices.begin(), each[i].notices.end());
  }
  if (more) add(*more, 1.0f);
  return all;
}

}  // namespace

Result<std::shared_ptr<const Environment>> LightCache::environment(
    const std::vector<spec::Light>& lights, const std::vector<float>& factors, const Options& options,
    const std::shared_ptr<const spec::DistantLights>& more) {
  // Lights within the scene are left out, so that dragging one of them does not change the sky.
  std::vector<spec::Light> distant;
  std::vector<float> of_distant;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (std::holds_alternative<spec::SphereLight>(lights[i]) ||
        std::holds_alternative<spec::DiscLight>(lights[i]))
      continue;
    distant.push_back(lights[i]);
    of_distant.push_back(i < factors.size() ? factors[i] : 1.0f);
  }
  if (loaded_from_.renew(distant)) {
    made_from_.forget();
    loaded_.clear();
    for (const spec::Light& light : distant) {
      auto loaded = spec::loadDistantLights({light});
      if (!loaded) {
        loaded_from_.forget();
        return failAgain(std::move(loaded.error()));
      }
      loaded_.push_back(std::move(*loaded));
    }
  }
  const int band_limit = options.band_limit ? options.band_limit->in : 0;
  if (made_from_.renew(of_distant, more, options.rotate_light_deg, band_limit)) {
    spec::DistantLights combined = together(loaded_, of_distant, more.get());
    notices_ = combined.notices;
    environment_ =
        std::make_shared<const Environment>(std::move(combined), options.rotate_light_deg, band_limit);
  }
  return environment_;
}

}  // namespace lambent::baker::reference
