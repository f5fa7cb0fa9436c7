#include "runtime/lighting/incident_light.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>

#include "runtime/sh/zonal.hpp"

namespace lambent::lighting {

namespace {

constexpr float kAnew = std::numeric_limits<float>::infinity();
// What moves by less than this share of a texel waits until everything rests.
constexpr float kLeastMotionTexels = 0.25f;

bool differs(const sh::LightVector& now, const sh::LightVector& before) {
  double change = 0.0, power = 0.0;
  for (std::size_t i = 0; i < sh::kMaxCoefficients; ++i) {
    const glm::dvec3 a(now.c[i]), b(before.c[i]);
    change += glm::dot(a - b, a - b);
    power += glm::dot(b, b);
  }
  return change > double{kLeastChange} * double{kLeastChange} * power;
}

void add(sh::LightVector& sum, const sh::LightVector& light, float factor) {
  for (std::size_t i = 0; i < sh::kMaxCoefficients; ++i) sum.c[i] += factor * light.c[i];
}

// Columns of rotation and scale: how far points at unit distance from the origin may have moved.
float turnBetween(const glm::mat4& a, const glm::mat4& b) {
  float turn = 0.0f;
  for (int column = 0; column < 3; ++column)
    turn = std::max(turn, glm::distance(glm::vec3(a[column]), glm::vec3(b[column])));
  return turn;
}

}  // namespace

IncidentLight::IncidentLight(Capture capture, const CaptureOptions& options)
    : capture_(std::move(capture)),
      order_(options.order),
      least_motion_rad_(kLeastMotionTexels * 0.5f * std::numbers::pi_v<float> /
                        static_cast<float>(options.size)) {}

Result<IncidentLight> IncidentLight::create(const CaptureOptions& options, const Environment& environment) {
  Result<Capture> capture = Capture::create(options, environment);
  if (!capture) return failAgain(capture.error());
  return IncidentLight(std::move(*capture), options);
}

void IncidentLight::takeDrawn(bool wait) {
  if (requests_.empty()) return;
  std::optional<std::vector<CapturedLight>> results = capture_.take(wait);
  if (!results) return;
  for (std::size_t i = 0; i < requests_.size(); ++i) {
    Request& request = requests_[i];
    // Groups may have gone since.
    if (request.group >= groups_.size() || request.sample >= groups_[request.group].samples.size()) continue;
    Sample& sample = groups_[request.group].samples[request.sample];
    request.drawn.result = std::move((*results)[i]);
    sample.drawn = std::move(request.drawn);
    sample.drawn_anew = true;
  }
  requests_.clear();
}

void IncidentLight::noticeLights(std::span<const IncidentGroup> groups, std::span<const LocalLight> lights) {
  groups_.resize(groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    groups_[g].samples.resize(groups[g].samples_ws.size());
    bool changed = groups_[g].lit_by != groups[g].lit_by || lights.size() != lights_before_.size();
    for (std::size_t k = 0; k < lights.size() && !changed; ++k)
      changed = groups[g].lit_by[k] != 0 && lights[k] != lights_before_[k];
    groups_[g].lit_by = groups[g].lit_by;
    if (changed) ++groups_[g].lights;
  }
  lights_before_.assign(lights.begin(), lights.end());
}

void IncidentLight::update(const Environment& environment, std::span<const IncidentGroup> groups,
                           std::span<const LocalLight> lights, bool wait) {
  counts_ = {.captured = counts_.captured, .waiting = counts_.waiting};
  takeDrawn(wait);
  noticeLights(groups, lights);
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (std::size_t s = 0; s < groups[g].samples_ws.size(); ++s)
      updateSample(groups_[g].samples[s], groups_[g], environment, groups[g].samples_ws[s], lights);
}

void IncidentLight::updateSample(Sample& sample, const Group& group, const Environment& environment,
                                 const glm::vec3& position_ws, std::span<const LocalLight> lights) {
  ++counts_.samples;
  const bool lit = std::ranges::find(group.lit_by, std::uint8_t{1}) != group.lit_by.end();
  if (!sample.drawn && !lit) {
    // GroupLights itself follows the environment.
    if (!sample.plain || sample.version == 0 || sample.environment != environment.version()) ++counts_.risen;
    if (!sample.plain || sample.version == 0) ++sample.version;
    sample.plain = true;
    sample.drawn_anew = false;
    sample.environment = environment.version();
    return;
  }
  // Where bodies stand around, a sky that turned waits for its capture.
  const bool new_sky = !sample.drawn && sample.environment != environment.version();
  const bool moved = lit && sample.position_ws != position_ws;
  if (!sample.drawn_anew && !moved && !new_sky && !sample.plain && sample.lights == group.lights) return;
  sample.drawn_anew = false;
  sample.position_ws = position_ws;
  sample.environment = environment.version();
  sample.lights = group.lights;

  const auto visible = [&](const std::vector<std::int32_t> Drawn::*queries, std::size_t index) {
    if (!sample.drawn || index >= ((*sample.drawn).*queries).size()) return 1.0f;
    const std::int32_t query = ((*sample.drawn).*queries)[index];
    return query < 0 ? 1.0f : sample.drawn->result.visible[static_cast<std::size_t>(query)];
  };
  sh::LightVector now(order_);
  add(now, sample.drawn ? sample.drawn->result.light : environment.skyLight().truncated(order_), 1.0f);
  for (std::size_t i = 0; i < environment.discs().size(); ++i) {
    const spec::Disc& disc = environment.discs()[i];
    const float share = visible(&Drawn::query_of_disc, i);
    if (share > 0.0f && disc.radiance != glm::vec3(0.0f))
      add(now, sh::discLight(order_, disc.direction, double{disc.radius_rad}, disc.radiance), share);
  }
  for (std::size_t k = 0; k < lights.size(); ++k) {
    if (group.lit_by[k] == 0) continue;
    const float share = visible(&Drawn::query_of_light, k);
    if (share > 0.0f) add(now, lightAt(lights[k], position_ws, order_), share);
  }
  if (!sample.plain && sample.version != 0 && !differs(now, sample.light)) return;
  sample.light = now;
  sample.plain = false;
  ++sample.version;
  ++counts_.risen;
}

bool IncidentLight::somethingMoves(std::span<const IncidentGroup> groups,
                                   std::span<const IncidentBody> bodies) {
  std::vector<glm::mat4> poses;
  for (const IncidentBody& body : bodies) poses.push_back(body.body.world_from_proxy);
  std::vector<glm::vec3> places;
  for (const IncidentGroup& group : groups)
    places.insert(places.end(), group.samples_ws.begin(), group.samples_ws.end());
  const bool moves = poses != bodies_before_ || places != places_before_;
  bodies_before_ = std::move(poses);
  places_before_ = std::move(places);
  return moves;
}

// How far things around the sample moved since it was drawn, in radians as seen from it; infinite if it has
// to be drawn anew.
float IncidentLight::changeAround(const Drawn& drawn, const Drawn& now,
                                  std::span<const IncidentBody> bodies) const {
  if (drawn.environment != now.environment || drawn.lights != now.lights ||
      drawn.seen.size() != now.seen.size())
    return kAnew;
  float change = 0.0f;
  for (std::size_t i = 0; i < now.seen.size(); ++i) {
    const SeenBody &then = drawn.seen[i], &here = now.seen[i];
    if (then.body != here.body || then.radiance_version != here.radiance_version) return kAnew;
    const glm::vec3 offset_then = then.center_ws - drawn.position_ws;
    const glm::vec3 offset_now = here.center_ws - now.position_ws;
    const float radius = bodies[here.body].radius_m;
    const float moved = glm::distance(offset_then, offset_now) +
                        radius * turnBetween(then.world_from_proxy, here.world_from_proxy);
    if (moved == 0.0f) continue;
    const float nearest = glm::length(offset_now) - radius;
    change = std::max(change, nearest > 0.0f ? moved / nearest : kAnew);
  }
  return change;
}

Result<void> IncidentLight::capture(const Environment& environment, std::span<const IncidentGroup> groups,
                                    std::span<const IncidentBody> bodies, std::span<const LocalLight> lights,
                                    const gpu::Buffer& triangle_radiance, gpu::Counters& counters) {
  counts_.captured = 0;
  if (!requests_.empty()) return {};  // the last one is still on its way
  counts_.waiting = 0;
  const float least_motion = somethingMoves(groups, bodies) ? least_motion_rad_ : 0.0f;
  std::vector<CapturePoint> points;
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (std::size_t s = 0; s < groups[g].samples_ws.size(); ++s) {
      Sample& sample = groups_[g].samples[s];
      CapturePoint point{.position_ws = groups[g].samples_ws[s], .own_body = groups[g].body, .queries = {}};
      Drawn now;
      now.position_ws = point.position_ws;
      now.environment = environment.version();
      now.lights = groups_[g].lights;
      for (std::uint32_t b = 0; b < bodies.size(); ++b)
        if (b != point.own_body && capture_.sees(point, bodies[b].body))
          now.seen.push_back(
              {b, bodies[b].body.world_from_proxy, bodies[b].center_ws, bodies[b].radiance_version});
      if (now.seen.empty()) {
        if (sample.drawn) ++counts_.waiting;  // for the next step, which finds nothing in the light's way
        sample.drawn_anew |= sample.drawn.has_value();
        sample.drawn.reset();
        continue;
      }
      if (sample.drawn) {
        const float change = changeAround(*sample.drawn, now, bodies);
        if (!(change > least_motion)) {
          counts_.waiting += change > 0.0f ? 1 : 0;
          continue;
        }
      }
      const auto ask = [&](const std::optional<LightQuery>& query, std::vector<std::int32_t>& places) {
        places.push_back(query ? static_cast<std::int32_t>(point.queries.size()) : -1);
        if (query) point.queries.push_back(*query);
      };
      for (const spec::Disc& disc : environment.discs()) {
        std::optional<LightQuery> query;
        if (disc.radiance != glm::vec3(0.0f))
          query = LightQuery{
              .direction = disc.direction, .angular_radius_rad = disc.radius_rad, .radiance = disc.radiance};
        ask(query, now.query_of_disc);
      }
      for (std::size_t k = 0; k < lights.size(); ++k)
        ask(groups[g].lit_by[k] != 0 ? queryOf(lights[k], point.position_ws) : std::nullopt,
            now.query_of_light);
      points.push_back(std::move(point));
      requests_.push_back({g, s, std::move(now)});
    }
  counts_.captured = static_cast<std::uint32_t>(points.size());
  if (points.empty()) return {};
  std::vector<CaptureBody> placed;
  for (const IncidentBody& body : bodies) placed.push_back(body.body);
  return capture_.run(environment, placed, points, triangle_radiance, counters);
}

bool IncidentLight::atRest() const {
  return requests_.empty() && counts_.waiting == 0 && counts_.risen == 0;
}

std::vector<Incident> IncidentLight::incidentOf(std::size_t group) const {
  std::vector<Incident> incident;
  for (const Sample& sample : groups_[group].samples)
    incident.push_back({.light = sample.plain ? nullptr : &sample.light, .version = sample.version});
  return incident;
}

}  // namespace lambent::lighting
