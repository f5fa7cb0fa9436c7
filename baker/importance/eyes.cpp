#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "baker/importance/importance.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

namespace {

constexpr float kHalfTurn = std::numbers::pi_v<float>;
constexpr std::size_t kTestRays = 48;     // with which a place is judged
constexpr std::size_t kMostCameras = 16;  // of a file; a few of many are as good as all
constexpr std::size_t kWalks = 16;        // eyes in the free space around cameras
constexpr std::size_t kRoomEyes = 16, kPlacesTried = 512;
constexpr std::size_t kEyesAround = 12;  // around the whole group, and as many around parts of it
constexpr float kOfCameras = 0.5f, kOfRooms = 0.6f, kOfWhole = 0.5f;
// An eye stands in a room if this share of its rays meet a front, and in something if this share meet a back.
constexpr float kEnclosed = 0.7f, kInside = 0.1f;
// Eyes around a body stand so many radii of its bounding sphere from its middle, as the default camera does.
constexpr float kRadii = 2.5f, kLeastRadii = 1.2f;

// Returns the i-th of n directions that are spread evenly over the sphere (a spiral of golden angles).
glm::vec3 spiral(std::size_t i, std::size_t n) {
  const float y = 1.0f - 2.0f * (static_cast<float>(i) + 0.5f) / static_cast<float>(n);
  const float round = std::sqrt(std::max(0.0f, 1.0f - y * y));
  const float turn = static_cast<float>(i) * kHalfTurn * (3.0f - std::sqrt(5.0f));
  return {round * std::cos(turn), y, round * std::sin(turn)};
}

glm::mat3 axesLooking(const glm::vec3& along) {
  const glm::vec3 up = std::abs(along.y) < 0.999f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  const glm::vec3 right = glm::normalize(glm::cross(along, up));
  return {right, glm::cross(right, along), -along};
}

struct Sight {
  float fronts = 0.0f, backs = 0.0f;  // shares of the rays
  float distance = 0.0f;              // the mean of those that meet a front, m
};

Sight sightFrom(const Eye& eye, const RayScene& rays, float reach) {
  std::vector<RaySegment> segments;
  for (std::size_t i = 0; i < kTestRays; ++i) segments.push_back({eye.position, eye.direction(i), reach});
  std::vector<FirstHit> hits(kTestRays);
  rays.firstHits(segments, hits);
  Sight sight;
  for (const FirstHit& hit : hits) {
    if (hit.back) sight.backs += 1.0f / kTestRays;
    if (!hit.any() || hit.back) continue;
    sight.fronts += 1.0f / kTestRays;
    sight.distance += hit.distance / kTestRays;
  }
  if (sight.fronts > 0.0f) sight.distance /= sight.fronts;
  return sight;
}

FirstHit firstHit(const RayScene& rays, const RaySegment& ray) {
  FirstHit hit;
  rays.firstHits(std::span(&ray, 1), std::span(&hit, 1));
  return hit;
}

class Placer {
 public:
  Placer(const GroupGeometry& geometry, const RayScene& rays)
      : geometry_(geometry),
        rays_(rays),
        reach_((kRadii + 1.0f) * glm::distance(geometry.bounds_min, geometry.bounds_max)) {}

  std::vector<Eye> place(std::vector<Eye> cameras) {
    if (cameras.size() > kMostCameras) {
      for (std::size_t i = 0; i < kMostCameras; ++i) cameras[i] = cameras[i * cameras.size() / kMostCameras];
      cameras.resize(kMostCameras);
    }
    std::erase_if(cameras, [&](const Eye& eye) { return !(sightFrom(eye, rays_, reach_).fronts > 0.0f); });
    if (!cameras.empty()) {
      add(cameras, kOfCameras);
      add(walksFrom(cameras), 1.0f - kOfCameras);
    } else {
      const std::vector<Eye> rooms = inRooms();
      const float outside = rooms.empty() ? 1.0f : 1.0f - kOfRooms;
      add(rooms, kOfRooms);
      add(aroundWhole(), outside * kOfWhole);
      add(aroundParts(), outside * (1.0f - kOfWhole));
    }
    float sum = 0.0f;
    for (const Eye& eye : eyes_) sum += eye.weight;
    for (Eye& eye : eyes_) eye.weight /= sum;
    return std::move(eyes_);
  }

 private:
  // Adds eyes that share a weight.
  void add(const std::vector<Eye>& eyes, float weight) {
    for (Eye eye : eyes) {
      eye.weight = weight / static_cast<float>(eyes.size());
      eyes_.push_back(eye);
    }
  }

  // An eye inside a solid body sees its back faces, and one in the open may see nothing.
  bool seesFronts(const Eye& eye) const {
    const Sight sight = sightFrom(eye, rays_, reach_);
    return sight.fronts > 0.0f && sight.backs <= kInside;
  }

  // Walks on from eye to eye through free space, a share of the free way at each step, but no further than
  // twice as far as the first eye sees.
  std::vector<Eye> walksFrom(const std::vector<Eye>& cameras) const {
    std::vector<Eye> walks;
    std::vector<glm::vec3> places;
    std::vector<float> steps;
    for (const Eye& camera : cameras) {
      places.push_back(camera.position);
      steps.push_back(2.0f * sightFrom(camera, rays_, reach_).distance);
    }
    for (std::size_t i = 0; i < 4 * kWalks && walks.size() < kWalks; ++i) {
      const std::size_t from = i % places.size();
      // People and cameras move along floors more than up and down.
      glm::vec3 along = spiral(i, 4 * kWalks);
      along = glm::normalize(along * glm::vec3(1.0f, 0.25f, 1.0f));
      const FirstHit hit = firstHit(rays_, {places[from], along, steps[from]});
      const float free = hit.any() ? hit.distance : steps[from];
      const Eye eye{.position = places[from] + (0.2f + 0.7f * radicalInverse(i + 1, 2)) * free * along};
      if (!seesFronts(eye)) continue;
      walks.push_back(eye);
      places.push_back(eye.position);
      steps.push_back(steps[from]);
    }
    return walks;
  }

  // Tries places all over the bounds and in front of faces, since a room may be small beside what lies around
  // it.
  std::vector<Eye> inRooms() const {
    std::vector<Eye> eyes;
    const std::size_t triangles = geometry_.triangles.size();
    for (std::size_t place = 1; place <= kPlacesTried && eyes.size() < kRoomEyes; ++place) {
      Eye eye;
      if (place % 2 == 0) {
        const glm::vec3 share(radicalInverse(place, 2), radicalInverse(place, 3), radicalInverse(place, 5));
        eye.position = glm::mix(geometry_.bounds_min, geometry_.bounds_max, share);
      } else {
        const auto t =
            std::min(static_cast<std::size_t>(radicalInverse(place, 3) * static_cast<float>(triangles)),
                     triangles - 1);
        const glm::uvec3 corners = geometry_.triangles[t];
        const glm::vec3 across = areaNormal(geometry_, corners);
        if (!(glm::length(across) > 0.0f)) continue;
        const glm::vec3 normal = glm::normalize(across),
                        middle = (geometry_.positions[corners.x] + geometry_.positions[corners.y] +
                                  geometry_.positions[corners.z]) /
                                 3.0f;
        const glm::vec3 from = middle + standOff(middle, longestEdge(geometry_, corners)) * normal;
        const FirstHit hit = firstHit(rays_, {from, normal, reach_});
        if (!hit.any()) continue;
        eye.position = from + (0.2f + 0.6f * radicalInverse(place, 5)) * hit.distance * normal;
      }
      const Sight sight = sightFrom(eye, rays_, reach_);
      if (sight.fronts >= kEnclosed && sight.backs <= kInside) eyes.push_back(eye);
    }
    return eyes;
  }

  // Returns an eye that looks at a sphere from this direction, as far away as there is room; nothing if there
  // is none.
  std::optional<Eye> lookingAt(const glm::vec3& middle, float radius, const glm::vec3& from) const {
    float distance = kRadii * radius;
    // The body itself hides its middle, so the way is free if nothing lies beyond its sphere.
    const glm::vec3 rim = middle + radius * from;
    const FirstHit hit = firstHit(rays_, {rim, from, distance - radius});
    if (hit.any()) distance = radius + 0.8f * hit.distance;
    if (distance < kLeastRadii * radius) return std::nullopt;
    const float sine = radius / distance;
    const Eye eye{.position = middle + distance * from,
                  .view = Eye::View::Cone,
                  .axes = axesLooking(-from),
                  .cone_cosine = std::sqrt(std::max(0.0f, 1.0f - sine * sine))};
    return seesFronts(eye) ? std::optional(eye) : std::nullopt;
  }

  std::vector<Eye> aroundWhole() const {
    std::vector<Eye> eyes;
    const glm::vec3 middle = 0.5f * (geometry_.bounds_min + geometry_.bounds_max);
    const float radius = 0.5f * glm::distance(geometry_.bounds_min, geometry_.bounds_max);
    for (std::size_t e = 0; e < kEyesAround; ++e)
      if (const auto eye = lookingAt(
              middle, radius, spiral(kEyesAround / 4 + e / 2 + (e % 2) * kEyesAround / 4, kEyesAround)))
        eyes.push_back(*eye);
    return eyes;
  }

  struct Ball {
    glm::vec3 middle{0.0f};
    float radius = 0.0f;
  };

  // Returns the bounding spheres of the connected parts of all draws, largest first.
  std::vector<Ball> parts() const;

  std::vector<Eye> aroundParts() const {
    const std::vector<Ball> balls = parts();
    std::vector<Eye> eyes;
    const std::size_t count = std::min(balls.size(), kEyesAround);
    for (std::size_t tries = 0; count > 0 && tries < 3 * kEyesAround && eyes.size() < kEyesAround; ++tries) {
      // Large parts are chosen more often than small ones: the places in the list are spaced by logarithm.
      const double share = static_cast<double>(tries % count) / static_cast<double>(count);
      const auto place = static_cast<std::size_t>(std::pow(static_cast<double>(balls.size()), share)) - 1;
      const Ball& ball = balls[std::max(place, tries % count)];
      // From above the horizon, most of them.
      glm::vec3 from = spiral(tries, 3 * kEyesAround);
      from = glm::normalize(glm::vec3(from.x, 0.3f + 0.5f * from.y, from.z));
      if (const auto eye = lookingAt(ball.middle, ball.radius, from)) eyes.push_back(*eye);
    }
    return eyes;
  }

  const GroupGeometry& geometry_;
  const RayScene& rays_;
  float reach_;
  std::vector<Eye> eyes_;
};

std::vector<Placer::Ball> Placer::parts() const {
  // Vertices at the same place belong together, since flat faces share none.
  std::vector<std::uint32_t> parent(geometry_.positions.size()), order(parent.size());
  std::iota(parent.begin(), parent.end(), 0u);
  std::iota(order.begin(), order.end(), 0u);
  const auto rootOf = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  const auto placeOf = [&](std::uint32_t v) {
    const glm::vec3& p = geometry_.positions[v];
    return std::tuple(p.x, p.y, p.z);
  };
  std::ranges::sort(order, {}, placeOf);
  for (std::size_t i = 1; i < order.size(); ++i)
    if (placeOf(order[i]) == placeOf(order[i - 1])) parent[rootOf(order[i])] = rootOf(order[i - 1]);
  for (const glm::uvec3& t : geometry_.triangles) {
    parent[rootOf(t.y)] = rootOf(t.x);
    parent[rootOf(t.z)] = rootOf(t.x);
  }
  struct Box {
    glm::vec3 low, high;
  };
  std::vector<std::optional<Box>> boxes(parent.size());
  for (std::uint32_t v = 0; v < parent.size(); ++v) {
    std::optional<Box>& box = boxes[rootOf(v)];
    if (!box) box = Box{geometry_.positions[v], geometry_.positions[v]};
    box->low = glm::min(box->low, geometry_.positions[v]);
    box->high = glm::max(box->high, geometry_.positions[v]);
  }
  std::vector<Ball> balls;
  for (const auto& box : boxes)
    if (box && box->low != box->high)
      balls.push_back({0.5f * (box->low + box->high), 0.5f * glm::distance(box->low, box->high)});
  std::ranges::stable_sort(balls, std::greater(), &Ball::radius);
  return balls;
}

}  // namespace

float radicalInverse(std::size_t i, std::size_t base) {
  double inverse = 0.0, digit = 1.0;
  for (; i > 0; i /= base) {
    digit /= static_cast<double>(base);
    inverse += digit * static_cast<double>(i % base);
  }
  return static_cast<float>(inverse);
}

glm::vec3 Eye::direction(std::size_t i) const {
  const float u = radicalInverse(i + 1, 2), v = radicalInverse(i + 1, 3);
  if (view == View::Frustum)
    return axes *
           glm::normalize(glm::vec3((2.0f * u - 1.0f) * tangent_x, (2.0f * v - 1.0f) * tangent_y, -1.0f));
  const float forward = 1.0f - u * (1.0f - cone_cosine), turn = 2.0f * kHalfTurn * v;
  const float aside = std::sqrt(std::max(0.0f, 1.0f - forward * forward));
  return axes * glm::vec3(aside * std::cos(turn), aside * std::sin(turn), -forward);
}

float Eye::density(const glm::vec3& direction) const {
  const glm::vec3 seen = glm::transpose(axes) * direction;
  const float forward = -seen.z;
  if (view != View::Frustum)
    return forward >= cone_cosine ? 1.0f / (2.0f * kHalfTurn * (1.0f - cone_cosine)) : 0.0f;
  if (!(forward > 0.0f) || std::abs(seen.x) > tangent_x * forward || std::abs(seen.y) > tangent_y * forward)
    return 0.0f;
  // Rays are uniform over the image plane, which a steradian covers by 1 / cos^3.
  return 1.0f / (4.0f * tangent_x * tangent_y * forward * forward * forward);
}

std::vector<Eye> cameraEyes(const Scene& scene, const RigidGroup& group, const GroupGeometry& geometry) {
  std::vector<Eye> eyes;
  const auto world = gltf::worldTransforms(scene.nodes);
  const glm::mat3 group_from_world = glm::transpose(glm::mat3_cast(group.rest_rotation));
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    if (scene.nodes[n].camera < 0) continue;
    const gltf::Camera& camera = scene.cameras[static_cast<std::size_t>(scene.nodes[n].camera)];
    const glm::mat3 turned = group_from_world * glm::mat3(world[n]);
    const glm::vec3 back = turned[2], side = turned[0];
    if (!(glm::length(back) > 0.0f) || !(glm::length(glm::cross(side, back)) > 0.0f)) continue;
    Eye eye{
        .position = group_from_world * (glm::vec3(world[n][3]) - group.rest_translation) - geometry.origin,
        .view = Eye::View::Frustum};
    const glm::vec3 backward = glm::normalize(back), up = glm::normalize(glm::cross(backward, side));
    eye.axes = {glm::cross(up, backward), up, backward};
    if (camera.perspective) {
      constexpr float kUsualAspect = 4.0f / 3.0f;
      eye.tangent_y = std::tan(0.5f * std::clamp(camera.yfov_rad, 0.01f, 3.0f));
      eye.tangent_x = eye.tangent_y * (camera.aspect > 0.0f ? camera.aspect : kUsualAspect);
    } else {
      // A parallel projection is seen as from its own place.
      const float distance =
          std::max(glm::distance(eye.position, 0.5f * (geometry.bounds_min + geometry.bounds_max)), 1e-6f);
      eye.tangent_x = std::max(std::abs(camera.xmag) / distance, 1e-3f);
      eye.tangent_y = std::max(std::abs(camera.ymag) / distance, 1e-3f);
    }
    eyes.push_back(eye);
  }
  return eyes;
}

void addEyes(std::span<const Eye> eyes, KeyMaker& key) {
  key.addText("eyes").add(std::uint64_t{eyes.size()});
  for (const Eye& eye : eyes)
    key.add(eye.position).add(eye.view).add(eye.axes).add(eye.tangent_x).add(eye.tangent_y);
}

std::vector<Eye> placeEyes(const GroupGeometry& geometry, const RayScene& rays, std::vector<Eye> cameras) {
  if (geometry.triangles.empty()) return {};
  return Placer(geometry, rays).place(std::move(cameras));
}

}  // namespace lambent::baker
