#include "baker/trace/emitters.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "baker/transport/geometry_key.hpp"
#include "baker/transport/panes.hpp"
#include "baker/transport/ray_scene.hpp"

namespace lambent::baker {

namespace {

// Limits on the number of points on each emitter.
constexpr std::size_t kLeastPoints = 32, kMostPoints = 256;
constexpr float kShortOf = 1.0f - 1e-4f;  // shadow rays end just before the surface

float fraction(double x) {
  return static_cast<float>(x - std::floor(x));
}

// Returns the origin that the i-th ray to an emitter starts from: the one dealt by weight, or else the next
// one with the point above its horizon. Returns null if there is none.
const SampleOrigin* originBelow(glm::vec3 point, std::size_t i, std::span<const SampleOrigin> origins,
                                const OriginDealer& dealer) {
  const std::size_t start = dealer.pick(i);
  for (std::size_t tries = 0; tries < origins.size(); ++tries) {
    const SampleOrigin& origin = origins[(start + tries) % origins.size()];
    if (isAbove(point - origin.position, origin)) return &origin;
  }
  return nullptr;
}

}  // namespace

void addLights(const Scene& scene, const GroupGeometry& geometry, std::span<const PlannedLight> lights,
               KeyMaker& key) {
  key.addText("lights").add(std::uint64_t{lights.size()});
  for (const PlannedLight& light : lights) {
    key.add(light.kind);
    if (light.kind == PlannedLight::Kind::Node) {
      const gltf::Node& node = scene.nodes[light.index];
      const gltf::Light& source = scene.lights[static_cast<std::size_t>(node.light)];
      key.add(light.group_from_node).add(geometry.origin);
      key.add(source.type).add(source.range_m).add(source.inner_cone_rad).add(source.outer_cone_rad);
      continue;
    }
    const gltf::Material& material = scene.materials[light.index];
    addTexture(scene, material.emissive_texture.texture, key);
    const bool textured = material.emissive_texture.texture >= 0;
    for (std::uint32_t d = 0; d < geometry.draws.size(); ++d) {
      const DrawGeometry& draw = geometry.draws[d];
      if (draw.material != static_cast<std::int32_t>(light.index)) continue;
      key.add(d);
      if (textured)
        key.addList(std::span(geometry.emissive_texcoords).subspan(draw.first_vertex, draw.vertex_count));
    }
  }
}

float punctualIrradiance(const gltf::Light& light, glm::vec3 light_direction, glm::vec3 to_surface) {
  const float squared = glm::dot(to_surface, to_surface), distance = std::sqrt(squared);
  if (!(squared > 0.0f)) return 0.0f;
  float value = 1.0f / squared;
  if (light.range_m > 0.0f) {
    const float ratio = distance / light.range_m;
    value *= std::clamp(1.0f - ratio * ratio * ratio * ratio, 0.0f, 1.0f);
  }
  if (light.type == gltf::Light::Type::Spot) {
    // KHR_lights_punctual suggests this falloff between the cones.
    const float inner = std::cos(light.inner_cone_rad), outer = std::cos(light.outer_cone_rad);
    const float scale = 1.0f / std::max(0.001f, inner - outer);
    const float along = glm::dot(light_direction, to_surface / distance);
    const float share = std::clamp((along - outer) * scale, 0.0f, 1.0f);
    value *= share * share;
  }
  return value;
}

Emitters::Emitters(const Scene& scene, const GroupGeometry& geometry, const SurfaceColors& colors,
                   std::span<const PlannedLight> lights, std::size_t points)
    : geometry_(geometry), colors_(colors), surface_of_light_(lights.size(), -1) {
  std::vector<std::vector<std::uint32_t>> triangles(lights.size());
  for (std::uint32_t t = 0; t < geometry.triangles.size(); ++t)
    if (const std::uint32_t light = colors.lightOf(t); light != kNoLight) triangles[light].push_back(t);
  const auto count = std::clamp(points / std::max<std::size_t>(lights.size(), 1), kLeastPoints, kMostPoints);
  for (std::uint32_t k = 0; k < lights.size(); ++k) {
    if (lights[k].kind == PlannedLight::Kind::Material) {
      Surface surface{.light = k, .area = 0.0f, .points = {}};
      choosePoints(count, surface, triangles[k]);
      if (surface.points.empty()) continue;
      surface_of_light_[k] = static_cast<std::int32_t>(surfaces_.size());
      surfaces_.push_back(std::move(surface));
    } else {
      const gltf::Node& node = scene.nodes[lights[k].index];
      const glm::mat4& place = lights[k].group_from_node;
      const glm::vec3 shines = -glm::vec3(place[2]);  // lights shine along -Z of their node
      punctual_.push_back({k, scene.lights[static_cast<std::size_t>(node.light)],
                           glm::vec3(place[3]) - geometry.origin,
                           glm::length(shines) > 0.0f ? glm::normalize(shines) : glm::vec3(0, 0, -1)});
    }
  }
}

void Emitters::choosePoints(std::size_t count, Surface& surface,
                            const std::vector<std::uint32_t>& triangles) const {
  std::vector<double> cumulated;
  double area = 0.0;
  const auto cornersOf = [&](std::uint32_t t) {
    const glm::uvec3 triangle = geometry_.triangles[t];
    return std::array{geometry_.positions[triangle.x], geometry_.positions[triangle.y],
                      geometry_.positions[triangle.z]};
  };
  for (const std::uint32_t t : triangles) {
    const auto [a, b, c] = cornersOf(t);
    area += 0.5 * double{glm::length(glm::cross(b - a, c - a))};
    cumulated.push_back(area);
  }
  if (!(area > 0.0)) return;
  surface.area = static_cast<float>(area);
  for (std::size_t i = 0; i < count; ++i) {
    // Even steps along the cumulated area pick the triangle; two dimensions of Roberts' R2 sequence (from the
    // plastic number) pick the place in it.
    const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(count) * area;
    const auto chosen = static_cast<std::size_t>(
        std::min<std::ptrdiff_t>(std::upper_bound(cumulated.begin(), cumulated.end(), at) - cumulated.begin(),
                                 static_cast<std::ptrdiff_t>(cumulated.size()) - 1));
    const float s = fraction(0.5 + 0.7548776662466927 * static_cast<double>(i));
    const float r = fraction(0.5 + 0.5698402909980532 * static_cast<double>(i));
    const float root = std::sqrt(s), u = root * (1.0f - r), v = root * r;
    const auto [a, b, c] = cornersOf(triangles[chosen]);
    surface.points.push_back({(1.0f - u - v) * a + u * b + v * c, glm::normalize(glm::cross(b - a, c - a)),
                              colors_.emission(triangles[chosen], u, v)});
  }
}

void Emitters::addMet(std::span<const RayHit> hits, std::span<const SampleOrigin> origins,
                      const glm::mat3& frame, LightReceiver& receiver) const {
  const OriginDealer dealer(origins);
  for (const RayHit& hit : hits) {
    const std::uint32_t light = colors_.lightOf(hit.triangle);
    if (light == kNoLight || surface_of_light_[light] < 0) continue;
    const Surface& surface = surfaces_[static_cast<std::size_t>(surface_of_light_[light])];
    const glm::uvec3 triangle = geometry_.triangles[hit.triangle];
    const glm::vec3 a = geometry_.positions[triangle.x], b = geometry_.positions[triangle.y],
                    c = geometry_.positions[triangle.z];
    const glm::vec3 point = (1.0f - hit.u - hit.v) * a + hit.u * b + hit.v * c;
    const glm::vec3 local = receiver.direction(hit.ray), straight = frame * local;
    const SampleOrigin& origin = origins[startOf(hit.ray, straight, origins, dealer)];
    const glm::vec3 offset = point - origin.position, direction = mirroredAbove(straight, origin);
    const float facing = -glm::dot(direction, glm::normalize(glm::cross(b - a, c - a)));
    if (!(facing > 0.0f)) continue;
    const float points_per_steradian =
        static_cast<float>(surface.points.size()) / surface.area * glm::dot(offset, offset) / facing;
    // Chosen points never reach the sample by way of the mirrored direction, so those rays count in full.
    const float share =
        isAbove(straight, origin)
            ? 1.0f - points_per_steradian / (points_per_steradian + receiver.raysPerSteradian(local.z))
            : 1.0f;
    const glm::vec3 radiance = share * hit.passed * colors_.emission(hit.triangle, hit.u, hit.v);
    receiver.addAlong(hit.ray, light, radiance);
  }
}

void Emitters::addChosen(std::span<const SampleOrigin> origins, const glm::mat3& frame, const RayScene& rays,
                         LightReceiver& receiver) const {
  struct Chosen {
    std::uint32_t light;
    glm::vec3 radiance;  // times all factors but the receiver's
    glm::vec3 local;
  };
  std::vector<RaySegment> segments;
  std::vector<Chosen> chosen;
  const OriginDealer dealer(origins);
  const glm::mat3 local_from_group = glm::transpose(frame);
  for (const Surface& surface : surfaces_)
    for (std::size_t i = 0; i < surface.points.size(); ++i) {
      const Point& point = surface.points[i];
      const SampleOrigin* origin = originBelow(point.position, i, origins, dealer);
      if (!origin || point.radiance == glm::vec3(0.0f)) continue;
      const glm::vec3 offset = point.position - origin->position;
      const float squared = glm::dot(offset, offset), distance = std::sqrt(squared);
      if (!(squared > 0.0f)) continue;
      const glm::vec3 direction = offset / distance, local = local_from_group * direction;
      const float facing = -glm::dot(direction, point.normal);
      if (!(facing > 0.0f) || !(local.z > 0.0f)) continue;
      // The balance heuristic gives the weight 1 / (points per steradian + rays per steradian), which
      // includes the division by the number of points.
      const float points_per_steradian =
          static_cast<float>(surface.points.size()) / surface.area * squared / facing;
      const float both = points_per_steradian + receiver.raysPerSteradian(local.z);
      segments.push_back({origin->position, direction, distance * kShortOf});
      chosen.push_back({surface.light, point.radiance / both, local});
    }
  for (const Punctual& light : punctual_)
    for (const SampleOrigin& origin : origins) {
      const glm::vec3 to_light = light.position - origin.position;
      const float distance = glm::length(to_light);
      if (!(distance > 0.0f)) continue;
      const glm::vec3 direction = to_light / distance, local = local_from_group * direction;
      if (!isAbove(direction, origin) || !(local.z > 0.0f)) continue;
      const float irradiance = punctualIrradiance(light.source, light.direction, -to_light);
      if (!(irradiance > 0.0f)) continue;
      segments.push_back({origin.position, direction, distance * kShortOf});
      chosen.push_back({light.light, glm::vec3(origin.weight * irradiance), local});
    }
  std::vector<std::uint8_t> blocked(segments.size());
  rays.occluded(segments, blocked);
  std::vector<glm::vec3> passed(segments.size());
  passedAlong(segments, rays, colors_, passed);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (blocked[i]) continue;
    receiver.addFrom(chosen[i].local, chosen[i].light, passed[i] * chosen[i].radiance);
  }
}

}  // namespace lambent::baker
