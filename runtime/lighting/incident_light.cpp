#include "runtime/lighting/incident_light.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>

#include "runtime/base/threads.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::lighting {

namespace {

constexpr std::size_t kGone = ~std::size_t{0};

// Returns whether either part of a light (with and without key lights) changed by more than kLeastChange of
// the whole.
bool differs(const DividedLight& now, const DividedLight& before) {
  double change = 0.0, power = 0.0;
  for (std::size_t i = 0; i < sh::kMaxCoefficients; ++i) {
    const glm::dvec3 rest_change(now.rest.c[i] - before.rest.c[i]),
        key_change(now.key.c[i] - before.key.c[i]), whole(before.rest.c[i] + before.key.c[i]);
    change += glm::dot(rest_change, rest_change) + glm::dot(key_change, key_change);
    power += glm::dot(whole, whole);
  }
  return change > double{kLeastChange} * double{kLeastChange} * power;
}

bool samePose(const IncidentBody& a, const IncidentBody& b) {
  return a.body.world_from_proxy == b.body.world_from_proxy && a.center_ws == b.center_ws &&
         a.radiance_drift == b.radiance_drift;
}

void add(sh::LightVector& sum, const sh::LightVector& light, float factor) {
  for (std::size_t i = 0; i < sh::kMaxCoefficients; ++i) sum.c[i] += factor * light.c[i];
}

// Returns how far points at unit distance from the origin may have moved, from the columns of rotation and
// scale.
float turnBetween(const glm::mat4& a, const glm::mat4& b) {
  float turn = 0.0f;
  for (int column = 0; column < 3; ++column)
    turn = std::max(turn, glm::distance(glm::vec3(a[column]), glm::vec3(b[column])));
  return turn;
}

}  // namespace

BodyChange changeOf(const IncidentBody& before, const glm::vec3& place_before, const IncidentBody& after,
                    const glm::vec3& place_after) {
  constexpr float kHalfTurn_rad = std::numbers::pi_v<float>;
  const float radius_m = after.radius_m;
  const auto drift = static_cast<float>(after.radiance_drift - before.radiance_drift);
  const glm::vec3 offset_before = before.center_ws - place_before,
                  offset_after = after.center_ws - place_after;
  const float moved = glm::distance(offset_before, offset_after) +
                      radius_m * turnBetween(before.body.world_from_proxy, after.body.world_from_proxy);
  const float distance = std::min(glm::length(offset_before), glm::length(offset_after));
  // Inside the body's sphere nothing can be ruled out.
  if (distance <= radius_m)
    return {.half_angle = kHalfTurn_rad, .angle = moved > 0.0f ? kHalfTurn_rad : 0.0f, .drift = drift};
  return {
      .half_angle = std::asin(radius_m / distance), .angle = moved / (distance - radius_m), .drift = drift};
}

float shareOfLight(const BodyChange& change, bool other, int order) {
  // A body that fills a share of the sphere contributes that share of the light's mean, and up to n times as
  // much in n bands (|y(d)|² = n²/4pi), but no more than all of it. Moved by an angle, its light differs from
  // itself by about n/2 times the angle (the parallax of a delta light), up to that of an unrelated light.
  const auto bands = static_cast<float>(order);
  constexpr float kOther = std::numbers::sqrt2_v<float>;
  const float parallax = other ? kOther : std::min(0.5f * bands * change.angle, kOther);
  const float share = std::min(0.5f * (1.0f - std::cos(change.half_angle)) * bands, 1.0f);
  return share * (parallax + change.drift);
}

bool passesLight(std::span<const LightQuery> queries, const glm::vec3& towards, float half_angle) {
  const float distance = glm::length(towards);
  return std::ranges::any_of(queries, [&](const LightQuery& query) {
    const float reach = half_angle + query.angular_radius_rad;
    return reach >= std::numbers::pi_v<float> || distance == 0.0f ||
           glm::dot(query.direction, towards) > distance * std::cos(reach);
  });
}

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
  counts_.waiting = std::max(counts_.waiting, 1u);  // not at rest before changes were looked for
}

void IncidentLight::leaveOut(Sample& sample, const std::vector<std::uint64_t>& left_out, bool fades) {
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
    // Groups and their samples may have gone in the meantime.
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

// Samples of a group that was baked again start with the light of the nearest former sample.
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

void IncidentLight::noticeLights(std::span<const IncidentGroup> groups, std::span<const LocalLight> lights) {
  followGroups(groups);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto same = [](const LightCarrier& a, const LightCarrier& b) {
      return a.harmonics() == b.harmonics() && a.apart() == b.apart();
    };
    bool changed = !std::ranges::equal(groups_[g].carriers, groups[g].carriers, same) ||
                   lights.size() != lights_before_.size();
    for (std::size_t k = 0; k < lights.size() && !changed; ++k)
      changed = groups[g].carriers[k].harmonics() && lights[k] != lights_before_[k];
    groups_[g].carriers = groups[g].carriers;
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
  const bool lit = std::ranges::any_of(group.carriers, &LightCarrier::harmonics);
  if (sample.fade_begins) {
    sample.fade_from = sample.plain ? DividedLight{environment.restLight().truncated(order_),
                                                   environment.keyLight().truncated(order_)}
                                    : sample.light;
    sample.fade_steps = kCarrierSteps;
    sample.fade_begins = false;
  }
  const bool fading = sample.fade_steps > 0;
  if (!sample.drawn && !lit && !fading) {
    // GroupLights itself follows changes of the environment.
    if (!sample.plain || sample.version == 0 || sample.environment != environment.version()) ++counts_.risen;
    if (!sample.plain || sample.version == 0) sample.version = ++version_;
    sample.plain = true;
    sample.drawn_anew = false;
    sample.environment = environment.version();
    return;
  }
  // Where bodies are in sight, a turned sky waits for its capture.
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
  DividedLight now{sh::LightVector(order_), sh::LightVector(order_)};
  add(now.rest, sample.drawn ? sample.drawn->result.light : environment.skyLight().truncated(order_), 1.0f);
  for (std::size_t i = 0; i < environment.discs().size(); ++i) {
    const spec::Disc& disc = environment.discs()[i];
    const float share = visible(&Drawn::query_of_disc, i);
    if (share > 0.0f && disc.radiance != glm::vec3(0.0f))
      add(environment.isKey(i) ? now.key : now.rest,
          sh::discLight(order_, disc.direction, double{disc.radius_rad}, disc.radiance), share);
  }
  for (std::size_t k = 0; k < lights.size(); ++k) {
    if (!group.carriers[k].harmonics()) continue;
    const float share = visible(&Drawn::query_of_light, k);
    if (share <= 0.0f) continue;
    const sh::LightVector light = lightAt(lights[k], position_ws, order_);
    const float apart = group.carriers[k].apart();
    add(now.rest, light, (1.0f - apart) * share);
    if (apart > 0.0f) add(now.key, light, apart * share);
  }
  if (fading) {
    ++counts_.fading;
    const float before = static_cast<float>(--sample.fade_steps) / static_cast<float>(kCarrierSteps);
    for (std::size_t i = 0; i < sh::kMaxCoefficients; ++i) {
      now.rest.c[i] = (1.0f - before) * now.rest.c[i] + before * sample.fade_from.rest.c[i];
      now.key.c[i] = (1.0f - before) * now.key.c[i] + before * sample.fade_from.key.c[i];
    }
  }
  const bool renewed = std::exchange(sample.renewed, false);
  if (!renewed && !sample.plain && sample.version != 0 && !differs(now, sample.light)) return;
  sample.light = now;
  sample.plain = false;
  sample.version = ++version_;
  ++counts_.risen;
}

bool IncidentLight::somethingShines(const Environment& environment, std::span<const IncidentBody> bodies) {
  // The version is split into halves, which doubles hold exactly.
  std::vector<double> shine = {static_cast<double>(environment.version() >> 32),
                               static_cast<double>(environment.version() & 0xffffffffu)};
  for (const Group& group : groups_) shine.push_back(static_cast<double>(group.lights));
  for (const IncidentBody& body : bodies) shine.push_back(body.radiance_drift);
  return shines_.renew(shine);
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
  return moves_.renew(poses, places, left_out);
}

Result<void> IncidentLight::capture(const Environment& environment, const IncidentScene& scene,
                                    const gpu::Buffer& triangle_radiance, std::size_t max_samples,
                                    gpu::Counters& counters) {
  const auto& [groups, bodies, lights] = scene;
  counts_.captured = 0;
  if (!requests_.empty()) return {};  // the last capture is still on its way
  const bool moves = somethingMoves(groups, bodies), shines = somethingShines(environment, bodies);
  if (!moves && !shines && nothing_to_draw_) return {};
  counts_.waiting = 0;
  const float least_change = moves ? kMovingChange : kRestingChange;
  noticeBodies(bodies);
  std::vector<LeftOut> left_out;
  for (const IncidentGroup& group : groups) left_out.push_back(leftOutOf(group));
  std::vector<Wanted> wanted;
  for (const Wanted& look : lookAround(environment, groups, left_out, lights)) {
    const IncidentGroup& group = groups[look.group];
    Sample& sample = groups_[look.group].samples[look.sample];
    if (look.change < 0.0f) {
      if (sample.drawn) ++counts_.waiting;  // for the next step, which finds the light unoccluded
      leaveOut(sample, left_out[look.group].keys, group.fades && sample.drawn.has_value());
      sample.drawn_anew |= sample.drawn.has_value();
      sample.drawn.reset();
    } else if (look.change > least_change) {
      wanted.push_back(look);
    } else if (look.change > kRestingChange) {
      ++counts_.waiting;
    }
  }
  // Samples that changed most come first. The others follow soon, because their changes add up while they
  // wait.
  std::ranges::stable_sort(wanted, std::ranges::greater(), &Wanted::change);
  if (wanted.size() > max_samples) {
    counts_.waiting += static_cast<std::uint32_t>(wanted.size() - max_samples);
    wanted.resize(max_samples);
  }
  nothing_to_draw_ = wanted.empty() && counts_.waiting == 0;
  if (wanted.empty()) return {};
  counts_.captured = static_cast<std::uint32_t>(wanted.size());
  std::vector<CapturePoint> points;
  std::vector<std::uint32_t> seen;
  for (const Wanted& one : wanted) {
    const IncidentGroup& group = groups[one.group];
    CapturePoint& point = points.emplace_back(CapturePoint{.position_ws = group.samples_ws[one.sample],
                                                           .own_body = group.body,
                                                           .queries = {},
                                                           .left_out = group.left_out});
    Drawn now;
    now.position_ws = point.position_ws;
    now.environment = environment.version();
    now.lights = groups_[one.group].lights;
    now.renewal = renewal_;
    now.left_out = left_out[one.group].keys;
    now.fades = group.fades;
    seeFrom(point.position_ws, left_out[one.group].ignored, seen);
    for (const std::uint32_t body : seen) now.seen.push_back(bodies_[body].now);
    askForLights(environment, group, lights, point, now);
    requests_.push_back({one.group, one.sample, std::move(now)});
  }
  std::vector<CaptureBody> placed;
  for (const IncidentBody& body : bodies) placed.push_back(body.body);
  return capture_.run(environment, placed, points, triangle_radiance, counters);
}

void IncidentLight::noticeBodies(std::span<const IncidentBody> bodies) {
  bodies_.clear();
  for (std::uint32_t b = 0; b < bodies.size(); ++b)
    bodies_.push_back({.now = bodies[b], .index = b, .sphere = capture_.sphereOf(bodies[b].body)});
  std::ranges::stable_sort(bodies_, {}, [](const Body& body) { return body.now.key; });
}

IncidentLight::LeftOut IncidentLight::leftOutOf(const IncidentGroup& group) const {
  LeftOut found;
  for (const Body& body : bodies_) {
    const bool left_out = std::ranges::binary_search(group.left_out, body.index);
    found.ignored.push_back(left_out || body.index == group.body);
    if (left_out) found.keys.push_back(body.now.key);
  }
  return found;
}

void IncidentLight::seeFrom(const glm::vec3& position_ws, const std::vector<bool>& ignored,
                            std::vector<std::uint32_t>& seen) const {
  seen.clear();
  for (std::uint32_t b = 0; b < bodies_.size(); ++b)
    if (!ignored[b] && capture::sees(capture_.options(), position_ws, bodies_[b].sphere)) seen.push_back(b);
}

// Returns all samples with the relative change of their light, or a negative number for those that see no
// body.
std::vector<IncidentLight::Wanted> IncidentLight::lookAround(const Environment& environment,
                                                             std::span<const IncidentGroup> groups,
                                                             std::span<const LeftOut> left_out,
                                                             std::span<const LocalLight> lights) const {
  std::vector<Wanted> looks;
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (std::size_t s = 0; s < groups[g].samples_ws.size(); ++s) looks.push_back({-1.0f, g, s});
  constexpr std::size_t kWorthAThread = 256;  // a millisecond with two hundred bodies
  inParallel(looks.size(), kWorthAThread, [&](std::size_t i) {
    Wanted& look = looks[i];
    const IncidentGroup& group = groups[look.group];
    std::vector<std::uint32_t> seen;
    seeFrom(group.samples_ws[look.sample], left_out[look.group].ignored, seen);
    if (seen.empty()) return;
    look.change = changeAround(look, environment, group, left_out[look.group], seen, lights);
  });
  return looks;
}

// Estimates how much of the light at the sample changed since it was drawn. Returns infinity if it has to be
// drawn anew.
float IncidentLight::changeAround(const Wanted& look, const Environment& environment,
                                  const IncidentGroup& group, const LeftOut& left_out,
                                  std::span<const std::uint32_t> seen,
                                  std::span<const LocalLight> lights) const {
  const Group& kept = groups_[look.group];
  if (!kept.samples[look.sample].drawn) return kWhollyChanged;
  const Drawn& drawn = *kept.samples[look.sample].drawn;
  if (drawn.environment != environment.version() || drawn.lights != kept.lights || drawn.renewal != renewal_)
    return kWhollyChanged;
  // A body that now reaches the group by another carrier would otherwise count twice, or not at all.
  if (drawn.left_out != left_out.keys) {
    const auto changed = [&](std::uint64_t key) {
      return std::ranges::binary_search(drawn.left_out, key) !=
             std::ranges::binary_search(left_out.keys, key);
    };
    if (std::ranges::any_of(drawn.seen, changed, &IncidentBody::key) ||
        std::ranges::any_of(seen, [&](std::uint32_t body) { return changed(bodies_[body].now.key); }))
      return kWhollyChanged;
  }
  const glm::vec3& position_ws = group.samples_ws[look.sample];
  const bool stays = drawn.position_ws == position_ws;
  std::optional<CapturePoint> point;  // what the sample would ask for; made only when something changed
  float change_squared = 0.0f;
  auto then = drawn.seen.begin();
  auto here = seen.begin();
  while (then != drawn.seen.end() || here != seen.end()) {
    const IncidentBody* was = then == drawn.seen.end() ? nullptr : &*then;
    const IncidentBody* is = here == seen.end() ? nullptr : &bodies_[*here].now;
    const bool gone = is == nullptr || (was != nullptr && was->key < is->key);
    const bool come = was == nullptr || (is != nullptr && is->key < was->key);
    if (gone || come || !stays || !samePose(*was, *is)) {
      const IncidentBody &before = come ? *is : *was, &after = gone ? *was : *is;
      const BodyChange change = changeOf(before, drawn.position_ws, after, position_ws);
      if (change.angle > 0.0f || gone || come) {
        if (!point) {
          Drawn asked;
          point.emplace(CapturePoint{.position_ws = position_ws, .queries = {}, .left_out = {}});
          askForLights(environment, group, lights, *point, asked);
        }
        if (passesLight(point->queries, after.center_ws - position_ws, change.half_angle + change.angle))
          return kWhollyChanged;
      }
      const float part = shareOfLight(change, gone || come, order_) * after.body.brightness;
      change_squared += part * part;  // as a sum of squares, since some changes brighten and some darken
    }
    if (!come) ++then;
    if (!gone) ++here;
  }
  return std::sqrt(change_squared);
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
      query = LightQuery{.direction = disc.direction, .angular_radius_rad = disc.radius_rad};
    ask(query, drawn.query_of_disc);
  }
  for (std::size_t k = 0; k < lights.size(); ++k) {
    std::optional<LightQuery> query;
    if (group.carriers[k].harmonics()) query = queryOf(lights[k], point.position_ws);
    ask(query, drawn.query_of_light);
  }
}

bool IncidentLight::atRest() const {
  return requests_.empty() && counts_.waiting == 0 && counts_.risen == 0 && counts_.fading == 0;
}

std::vector<Incident> IncidentLight::incidentOf(std::size_t group) const {
  std::vector<Incident> incident;
  for (const Sample& sample : groups_[group].samples)
    incident.push_back({.light = sample.plain ? nullptr : &sample.light.rest,
                        .key = sample.plain ? nullptr : &sample.light.key,
                        .version = sample.version});
  return incident;
}

}  // namespace lambent::lighting
