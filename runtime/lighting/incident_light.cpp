#include "runtime/lighting/incident_light.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>

#include "runtime/sh/zonal.hpp"

namespace lambent::lighting {

namespace {

constexpr std::uint64_t kNoVersion = ~std::uint64_t{0};
constexpr std::size_t kGone = ~std::size_t{0};
constexpr float kAnew = std::numeric_limits<float>::infinity();

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

// How a body's sphere moved as seen from a sample.
struct BodyChange {
  float half_angle = 0.0f, angle = 0.0f;  // radians
};

BodyChange changeOf(float radius, const glm::vec3& offset_before, const glm::vec3& offset_after, float turn) {
  constexpr float kPi = std::numbers::pi_v<float>;
  const float moved = glm::distance(offset_before, offset_after) + radius * turn;
  const float distance = std::min(glm::length(offset_before), glm::length(offset_after));
  // Inside its sphere anything may have happened.
  if (distance <= radius) return {.half_angle = kPi, .angle = moved > 0.0f ? kPi : 0.0f};
  return {.half_angle = std::asin(radius / distance), .angle = moved / (distance - radius)};
}

// Whether a body in this direction may hide part of a light that was asked for.
bool passesLight(const CapturePoint& point, const glm::vec3& towards, float half_angle) {
  const float distance = glm::length(towards);
  return std::ranges::any_of(point.queries, [&](const LightQuery& query) {
    const float reach = half_angle + query.angular_radius_rad;
    return reach >= std::numbers::pi_v<float> || distance == 0.0f ||
           glm::dot(query.direction, towards) > distance * std::cos(reach);
  });
}

}  // namespace

Result<IncidentLight> IncidentLight::create(const CaptureOptions& options, const Environment& environment) {
  Result<Capture> capture = Capture::create(options, environment);
  if (!capture) return failAgain(capture.error());
  return IncidentLight(std::move(*capture), options.order);
}

Result<void> IncidentLight::renew(const CaptureOptions& options, const Environment& environment) {
  Result<Capture> capture = Capture::create(options, environment);
  if (!capture) return failAgain(capture.error());
  capture_ = std::move(*capture);
  order_ = options.order;
  requests_.clear();
  forget();
  return {};
}

void IncidentLight::forget() {
  ++renewal_;
  nothing_to_draw_ = false;
  counts_.waiting = std::max(counts_.waiting, 1u);  // not at rest before it was looked for
}

void IncidentLight::leaveOut(Sample& sample, const std::vector<std::uint32_t>& left_out, bool fades) {
  if (sample.left_out == left_out) return;
  sample.left_out = left_out;
  sample.fade_begins = fades && sample.version != 0;
}

void IncidentLight::takeDrawn(bool wait) {
  if (requests_.empty()) return;
  std::optional<std::vector<CapturedLight>> results = capture_.take(wait);
  if (!results) return;
  counts_.arrived = static_cast<std::uint32_t>(requests_.size());
  for (std::size_t i = 0; i < requests_.size(); ++i) {
    Request& request = requests_[i];
    // Groups and their samples may have gone since.
    if (request.group >= groups_.size() || request.sample >= groups_[request.group].samples.size()) continue;
    Sample& sample = groups_[request.group].samples[request.sample];
    request.drawn.result = std::move((*results)[i]);
    leaveOut(sample, request.drawn.left_out, request.drawn.fades);
    sample.renewed = sample.drawn && sample.drawn->renewal != request.drawn.renewal;
    sample.drawn = std::move(request.drawn);
    sample.drawn_anew = true;
  }
  requests_.clear();
}

// Samples of a group that was baked anew begin with the light of what was nearest to them.
void IncidentLight::renewSamples(Group& group, const IncidentGroup& now) {
  std::vector<Sample> samples(now.samples_ws.size());
  std::uint64_t version = 0;
  for (const Sample& sample : group.samples) version = std::max(version, sample.version);
  for (std::size_t s = 0; s < samples.size() && !group.samples.empty(); ++s) {
    const auto nearest = std::ranges::min_element(
        group.places_ws, {}, [&](const glm::vec3& place) { return glm::distance(place, now.samples_ws[s]); });
    samples[s] = group.samples[static_cast<std::size_t>(nearest - group.places_ws.begin())];
    if (samples[s].version != 0) samples[s].version = version + 1;
  }
  group.samples = std::move(samples);
}

void IncidentLight::followGroups(std::span<const IncidentGroup> groups) {
  const std::vector<std::uint64_t> before = groups_.keys();
  if (groups_.follow(groups, &IncidentGroup::key))
    for (Request& request : requests_) {
      if (request.group >= before.size()) continue;
      const auto now = std::ranges::find(groups, before[request.group], &IncidentGroup::key);
      request.group = now == groups.end() ? kGone : static_cast<std::size_t>(now - groups.begin());
    }
  for (std::size_t g = 0; g < groups.size(); ++g) {
    Group& group = groups_[g];
    if (group.samples_seen != groups[g].samples || group.samples.size() != groups[g].samples_ws.size()) {
      renewSamples(group, groups[g]);
      for (Request& request : requests_)
        if (request.group == g) request.group = kGone;
    }
    group.samples_seen = groups[g].samples;
    group.places_ws = groups[g].samples_ws;
  }
}

// Bodies of all that is kept, by their indices from now on. Those that went stand behind all others.
void IncidentLight::followBodies(std::span<const IncidentBody> bodies) {
  if (std::ranges::equal(bodies, body_keys_, {}, &IncidentBody::key)) return;
  std::vector<std::uint32_t> now(body_keys_.size(), CapturePoint::kNoBody);
  std::vector<bool> taken(bodies.size(), false);
  for (std::size_t b = 0; b < body_keys_.size(); ++b)
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (!taken[i] && bodies[i].key == body_keys_[b]) {
        now[b] = static_cast<std::uint32_t>(i);
        taken[i] = true;
        break;
      }
  const auto place = [&](std::uint32_t body) {
    return body < now.size() ? now[body] : CapturePoint::kNoBody;
  };
  const auto renumber = [&](std::vector<std::uint32_t>& left_out) {
    for (std::uint32_t& body : left_out) body = place(body);
    std::erase(left_out, CapturePoint::kNoBody);
    std::ranges::sort(left_out);
  };
  const auto renumberDrawn = [&](Drawn& drawn) {
    for (SeenBody& seen : drawn.seen) seen.body = place(seen.body);
    std::ranges::stable_sort(drawn.seen, {}, &SeenBody::body);
    renumber(drawn.left_out);
  };
  for (Group& group : groups_)
    for (Sample& sample : group.samples) {
      renumber(sample.left_out);
      if (sample.drawn) renumberDrawn(*sample.drawn);
    }
  for (Request& request : requests_) renumberDrawn(request.drawn);
  body_keys_.clear();
  for (const IncidentBody& body : bodies) body_keys_.push_back(body.key);
}

void IncidentLight::noticeLights(std::span<const IncidentGroup> groups, std::span<const LocalLight> lights) {
  followGroups(groups);
  for (std::size_t g = 0; g < groups.size(); ++g) {
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
  if (sample.fade_begins) {
    sample.fade_from = sample.plain ? environment.light().truncated(order_) : sample.light;
    sample.fade_steps = kCarrierSteps;
    sample.fade_begins = false;
  }
  const bool fading = sample.fade_steps > 0;
  if (!sample.drawn && !lit && !fading) {
    // GroupLights itself follows the environment.
    if (!sample.plain || sample.version == 0 || sample.environment != environment.version()) ++counts_.risen;
    if (!sample.plain || sample.version == 0) sample.version = ++version_;
    sample.plain = true;
    sample.drawn_anew = false;
    sample.environment = environment.version();
    return;
  }
  // Where bodies stand around, a sky that turned waits for its capture.
  const bool new_sky = !sample.drawn && sample.environment != environment.version();
  const bool moved = lit && sample.position_ws != position_ws;
  if (!sample.drawn_anew && !moved && !new_sky && !sample.plain && !fading && sample.lights == group.lights)
    return;
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
  if (fading) {
    ++counts_.fading;
    const float before = static_cast<float>(--sample.fade_steps) / static_cast<float>(kCarrierSteps);
    for (std::size_t i = 0; i < sh::kMaxCoefficients; ++i)
      now.c[i] = (1.0f - before) * now.c[i] + before * sample.fade_from.c[i];
  }
  const bool renewed = std::exchange(sample.renewed, false);
  if (!renewed && !sample.plain && sample.version != 0 && !differs(now, sample.light)) return;
  sample.light = now;
  sample.plain = false;
  sample.version = ++version_;
  ++counts_.risen;
}

bool IncidentLight::somethingShines(const Environment& environment, std::span<const IncidentBody> bodies) {
  // In halves, which are exact.
  std::vector<double> shine = {static_cast<double>(environment.version() >> 32),
                               static_cast<double>(environment.version() & 0xffffffffu)};
  for (const Group& group : groups_) shine.push_back(static_cast<double>(group.lights));
  for (const IncidentBody& body : bodies) shine.push_back(body.radiance_drift);
  const bool changed = shine != shine_before_;
  shine_before_ = std::move(shine);
  return changed;
}

bool IncidentLight::somethingMoves(std::span<const IncidentGroup> groups,
                                   std::span<const IncidentBody> bodies) {
  std::vector<glm::mat4> poses;
  for (const IncidentBody& body : bodies) poses.push_back(body.body.world_from_proxy);
  std::vector<glm::vec3> places;
  std::vector<std::vector<std::uint32_t>> left_out;
  for (const IncidentGroup& group : groups) {
    places.insert(places.end(), group.samples_ws.begin(), group.samples_ws.end());
    left_out.push_back(group.left_out);
  }
  const bool moves = poses != bodies_before_ || places != places_before_ || left_out != left_out_before_;
  left_out_before_ = std::move(left_out);
  bodies_before_ = std::move(poses);
  places_before_ = std::move(places);
  return moves;
}

// How much of the light at the sample changed since it was drawn, as an estimate; infinite if it has to be
// drawn anew.
float IncidentLight::changeAround(const Drawn& drawn, const Drawn& now, std::span<const IncidentBody> bodies,
                                  const CapturePoint& point) const {
  if (drawn.environment != now.environment || drawn.lights != now.lights || drawn.renewal != now.renewal)
    return kAnew;
  // A body that reaches the group by another way now would count twice, or not at all.
  if (drawn.left_out != now.left_out) {
    const auto changed = [&](const SeenBody& seen) {
      return std::ranges::binary_search(drawn.left_out, seen.body) !=
             std::ranges::binary_search(now.left_out, seen.body);
    };
    if (std::ranges::any_of(drawn.seen, changed) || std::ranges::any_of(now.seen, changed)) return kAnew;
  }
  float change_squared = 0.0f;
  auto then = drawn.seen.begin();
  auto here = now.seen.begin();
  while (then != drawn.seen.end() || here != now.seen.end()) {
    const bool gone = here == now.seen.end() || (then != drawn.seen.end() && then->body < here->body);
    const bool come = !gone && (then == drawn.seen.end() || here->body < then->body);
    const SeenBody& before = come ? *here : *then;
    const SeenBody& after = gone ? *then : *here;
    if (before.body >= bodies.size()) return kAnew;
    const IncidentBody& body = bodies[before.body];
    const BodyChange moved =
        changeOf(body.radius_m, before.center_ws - drawn.position_ws, after.center_ws - now.position_ws,
                 turnBetween(before.world_from_proxy, after.world_from_proxy));
    const bool other = gone || come;
    if (moved.angle > 0.0f || other) {
      if (passesLight(point, after.center_ws - now.position_ws, moved.half_angle + moved.angle)) return kAnew;
    }
    // A body that fills a share of the sphere makes up so much of the light's mean, and n times as much of n
    // bands of it (|y(d)|² = n²/4pi), up to all of it. Turned by an angle, it differs from itself by about
    // n/2 times the angle (the parallax of a delta light), until it is another altogether.
    const auto bands = static_cast<float>(order_);
    constexpr float kOther = std::numbers::sqrt2_v<float>;
    const float parallax = other ? kOther : std::min(0.5f * bands * moved.angle, kOther);
    const auto drift = static_cast<float>(after.radiance_drift - before.radiance_drift);
    const float share = std::min(0.5f * (1.0f - std::cos(moved.half_angle)) * bands, 1.0f);
    const float part = share * body.body.brightness * (parallax + drift);
    change_squared += part * part;  // some brighten, some darken
    if (!come) ++then;
    if (!gone) ++here;
  }
  return std::sqrt(change_squared);
}

Result<void> IncidentLight::capture(const Environment& environment, std::span<const IncidentGroup> groups,
                                    std::span<const IncidentBody> bodies, std::span<const LocalLight> lights,
                                    const gpu::Buffer& triangle_radiance, std::size_t max_samples,
                                    gpu::Counters& counters) {
  counts_.captured = 0;
  followBodies(bodies);
  if (!requests_.empty()) return {};  // the last one is still on its way
  const bool moves = somethingMoves(groups, bodies), shines = somethingShines(environment, bodies);
  if (!moves && !shines && nothing_to_draw_) return {};
  counts_.waiting = 0;
  const float least_change = moves ? kMovingChange : kRestingChange;
  std::vector<Wanted> wanted;
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (std::size_t s = 0; s < groups[g].samples_ws.size(); ++s) {
      Sample& sample = groups_[g].samples[s];
      CapturePoint point{.position_ws = groups[g].samples_ws[s],
                         .own_body = groups[g].body,
                         .queries = {},
                         .left_out = groups[g].left_out};
      Drawn now;
      now.position_ws = point.position_ws;
      now.environment = environment.version();
      now.lights = groups_[g].lights;
      now.renewal = renewal_;
      now.left_out = groups[g].left_out;
      now.fades = groups[g].fades;
      for (std::uint32_t b = 0; b < bodies.size(); ++b)
        if (!point.ignores(b) && capture_.sees(point, bodies[b].body))
          now.seen.push_back(
              {b, bodies[b].body.world_from_proxy, bodies[b].center_ws, bodies[b].radiance_drift});
      if (now.seen.empty()) {
        if (sample.drawn) ++counts_.waiting;  // for the next step, which finds nothing in the light's way
        leaveOut(sample, now.left_out, now.fades && sample.drawn.has_value());
        sample.drawn_anew |= sample.drawn.has_value();
        sample.drawn.reset();
        continue;
      }
      askForLights(environment, groups[g], lights, point, now);
      const float change = sample.drawn ? changeAround(*sample.drawn, now, bodies, point) : kAnew;
      if (change > least_change)
        wanted.push_back({change, {g, s, std::move(now)}, std::move(point)});
      else if (change > kRestingChange)
        ++counts_.waiting;
    }
  // What changed most first; the others have their turn soon, for what they wait for adds up.
  std::stable_sort(wanted.begin(), wanted.end(),
                   [](const Wanted& a, const Wanted& b) { return a.change > b.change; });
  if (wanted.size() > max_samples) {
    counts_.waiting += static_cast<std::uint32_t>(wanted.size() - max_samples);
    wanted.resize(max_samples);
  }
  nothing_to_draw_ = wanted.empty() && counts_.waiting == 0;
  if (wanted.empty()) return {};
  counts_.captured = static_cast<std::uint32_t>(wanted.size());
  std::vector<CapturePoint> points;
  for (Wanted& one : wanted) {
    points.push_back(std::move(one.point));
    requests_.push_back(std::move(one.request));
  }
  std::vector<CaptureBody> placed;
  for (const IncidentBody& body : bodies) placed.push_back(body.body);
  return capture_.run(environment, placed, points, triangle_radiance, counters);
}

void IncidentLight::askForLights(const Environment& environment, const IncidentGroup& group,
                                 std::span<const LocalLight> lights, CapturePoint& point, Drawn& drawn) {
  const auto ask = [&](const std::optional<LightQuery>& query, std::vector<std::int32_t>& places) {
    places.push_back(query ? static_cast<std::int32_t>(point.queries.size()) : -1);
    if (query) point.queries.push_back(*query);
  };
  for (const spec::Disc& disc : environment.discs()) {
    std::optional<LightQuery> query;
    if (disc.radiance != glm::vec3(0.0f))
      query = LightQuery{
          .direction = disc.direction, .angular_radius_rad = disc.radius_rad, .radiance = disc.radiance};
    ask(query, drawn.query_of_disc);
  }
  for (std::size_t k = 0; k < lights.size(); ++k)
    ask(group.lit_by[k] != 0 ? queryOf(lights[k], point.position_ws) : std::nullopt, drawn.query_of_light);
}

bool IncidentLight::atRest() const {
  return requests_.empty() && counts_.waiting == 0 && counts_.risen == 0 && counts_.fading == 0;
}

std::vector<Incident> IncidentLight::incidentOf(std::size_t group) const {
  std::vector<Incident> incident;
  for (const Sample& sample : groups_[group].samples)
    incident.push_back({.light = sample.plain ? nullptr : &sample.light, .version = sample.version});
  return incident;
}

}  // namespace lambent::lighting
