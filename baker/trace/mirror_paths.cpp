#include "baker/trace/mirror_paths.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "baker/brdf/surface_brdfs.hpp"
#include "baker/plan/smooth_dielectrics.hpp"
#include "baker/transport/panes.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

namespace {

// Where light is reflected this often, what is left leaves the last mirror by its exit kernel.
constexpr std::uint32_t kMostReflections = 16;

bool isBlack(const GatherHit& hit) {
  return std::all_of(std::begin(hit.albedo), std::end(hit.albedo), [](std::uint16_t a) { return a == 0; });
}

// Layers are followed by this many times as many paths as there would be if each passed on all the light of
// its ray. With more of them there is less noise, and less to code (docs/design/glossy.md).
constexpr float kPathsInLayer = 8.0f;

// Returns numbers from 0 to 1 that are evenly spread for successive numbers: multiples of the golden ratio.
float evenly(std::uint32_t number) {
  return static_cast<float>(number * 2654435769u >> 8) * 0x1p-24f;
}

// Spreads the numbers of samples, so that neighbours do not make the same choices.
std::uint32_t scattered(std::size_t sample) {
  std::uint32_t hash = static_cast<std::uint32_t>(sample) * 0x9E3779B9u;
  hash = (hash ^ hash >> 16) * 0x7FEB352Du;
  return hash ^ hash >> 15;
}

}  // namespace

bool MirrorPaths::isSharp(const GatherHit& hit) const {
  return brdfs_.glossy(hit.triangle) &&
         brdfs_.roughness(hit.triangle, hit.uAt(), hit.vAt()) < kMirrorRoughness;
}

float MirrorPaths::leaveBase(const glm::vec3& along, GatherHit& hit) const {
  const float u = hit.uAt(), v = hit.vAt();
  const glm::vec3 normal =
      interpolatedNormal(geometry_, geometry_.triangles[hit.triangle], {1.0f - u - v, u, v});
  const float length = glm::length(normal);
  const float reflected =
      brdfs_.layerAlbedo(hit.triangle, length > 0.0f ? -glm::dot(along, normal) / length : 0.0f);
  hit.setAlbedo((1.0f - reflected) * baseUnderLayer(hit.albedoAt(), colors_.layer(hit.triangle)));
  const float of_pane = colors_.paneReflectance(hit.triangle);
  return of_pane > 0.0f ? std::min(reflected, of_pane) : reflected;
}

// Follows all paths of a range at once, a reflection at a time.
class MirrorPaths::Walk {
 public:
  Walk(const MirrorPaths& mirrors, RangeHits& hits) : mirrors_(mirrors), hits_(hits) {}

  // Says where a path begins: at a hit that a sample sees along a ray of this direction, with this
  // throughput.
  struct Start {
    std::size_t index, sample;
    std::uint32_t number;
    glm::vec3 along, throughput;
  };
  // Starts a path. The hit at a layer stays for the base.
  void start(const Start& at, bool from_layer) {
    paths_.push_back({.hit = hits_.hits[at.index],
                      .along = at.along,
                      .throughput = at.throughput,
                      .index = at.index,
                      .sample = static_cast<std::uint32_t>(at.sample),
                      .number = at.number,
                      .from_layer = from_layer});
  }
  // Takes what the surface at a hit sends, which is not diffuse, with the path's throughput.
  void end(const Start& at) {
    start(at, /*from_layer=*/false);
    add(MirroredLight::From::Kernel, paths_.back(), -at.along, at.throughput);
    paths_.pop_back();
    hits_.hits[at.index].triangle = kNowhere;
  }

  void follow() {
    std::vector<RaySegment> rays;
    std::vector<FirstHit> met;
    for (std::uint32_t reflection = 0; reflection < kMostReflections && !paths_.empty(); ++reflection) {
      std::erase_if(paths_, [&](Path& path) { return !reflect(path, reflection); });
      rays.clear();
      for (const Path& path : paths_)
        rays.push_back({path.from, path.ray, std::numeric_limits<float>::infinity()});
      met.resize(rays.size());
      mirrors_.rays_.firstHits(rays, met);
      passPanes(met, rays);
      std::size_t next = 0;
      std::erase_if(paths_, [&](Path& path) { return !meet(path, met[next++]); });
    }
    for (const Path& path : paths_) add(MirroredLight::From::Kernel, path, -path.along, path.throughput);
  }

  // Takes out the hits that paths began at and that no diffuse surface replaced, and sorts what they found.
  void finish(const std::vector<std::uint8_t>& begun) {
    std::size_t left = 0;
    for (std::size_t s = 0; s + 1 < hits_.offsets.size(); ++s) {
      const std::size_t begin = std::exchange(hits_.offsets[s], static_cast<std::uint32_t>(left));
      for (std::size_t h = begin; h < hits_.offsets[s + 1]; ++h)
        if (begun[h] == 0 || hits_.hits[h].triangle != kNowhere) hits_.hits[left++] = hits_.hits[h];
    }
    hits_.offsets.back() = static_cast<std::uint32_t>(left);
    hits_.hits.resize(left);

    // Of one ray, what was found after fewer reflections comes first.
    std::stable_sort(found_.begin(), found_.end(), [](const Found& a, const Found& b) {
      return std::pair(a.sample, a.light.hit.ray) < std::pair(b.sample, b.light.hit.ray);
    });
    hits_.mirrored_offsets.assign(hits_.offsets.size(), 0);
    for (const Found& found : found_) {
      ++hits_.mirrored_offsets[found.sample + 1];
      hits_.mirrored.push_back(found.light);
    }
    for (std::size_t s = 1; s < hits_.mirrored_offsets.size(); ++s)
      hits_.mirrored_offsets[s] += hits_.mirrored_offsets[s - 1];
  }

 private:
  // Hits of paths that did not end on a diffuse surface.
  static constexpr std::uint32_t kNowhere = 0xffffffffu;

  struct Path {
    GatherHit hit;                    // the last one; `ray` is the sample's
    glm::vec3 along{0.0f};            // to the hit
    glm::vec3 from{0.0f}, ray{0.0f};  // where it goes on
    glm::vec3 throughput;
    std::size_t index;  // of the hit that it began at
    std::uint32_t sample, number;
    bool from_layer;  // it began at a hit on a layer, which stays
  };
  struct Found {
    std::uint32_t sample;
    MirroredLight light;
  };

  // Weakens paths by the panes on their rays, up to what these met.
  void passPanes(const std::vector<FirstHit>& met, std::vector<RaySegment>& rays) {
    if (!mirrors_.rays_.hasPanes()) return;
    for (std::size_t i = 0; i < rays.size(); ++i) rays[i].length = met[i].distance;
    std::vector<glm::vec3> passed(rays.size());
    passedAlong(rays, mirrors_.rays_, mirrors_.colors_, passed);
    for (std::size_t i = 0; i < paths_.size(); ++i) paths_[i].throughput *= passed[i];
  }

  void add(MirroredLight::From from, const Path& path, const glm::vec3& direction, const glm::vec3& factor) {
    MirroredLight light{.hit = path.hit, .direction = direction, .from = from};
    light.hit.setAlbedo(factor);
    if (!isBlack(light.hit)) found_.push_back({path.sample, light});
  }

  // Directs a path into the highlight at its hit. Returns false if it ends there.
  bool reflect(Path& path, std::uint32_t reflection) {
    const bool in_layer = path.from_layer && reflection == 0;
    // The hit is left to diffuse surfaces that the path may meet.
    if (reflection == 0 && !in_layer) hits_.hits[path.index].triangle = kNowhere;
    const GatherHit hit = path.hit;
    const float u = hit.uAt(), v = hit.vAt();
    const glm::uvec3 t = mirrors_.geometry_.triangles[hit.triangle];
    const auto& positions = mirrors_.geometry_.positions;
    const glm::vec3 a = positions[t.x], b = positions[t.y], c = positions[t.z];
    PointReflection at = mirrors_.brdfs_.reflection(hit.triangle, u, v, -path.along);
    // Rays of glossy samples may have been mirrored at the sample's horizon.
    const float below = std::min(-glm::dot(path.along, at.geometric), 0.0f);
    const glm::vec3 to = glm::normalize(-path.along - 2.0f * below * at.geometric);
    using From = MirroredLight::From;
    if (in_layer) {
      const float reflected = mirrors_.brdfs_.layerAlbedo(hit.triangle, glm::dot(to, at.normal));
      if (const float of_pane = mirrors_.colors_.paneReflectance(hit.triangle); of_pane > 0.0f)
        path.throughput *= std::min(of_pane / reflected, 1.0f);
      if (mirrors_.with_lights_) add(From::LightsByLayer, path, to, path.throughput * reflected);
    } else {
      if (mirrors_.with_lights_) add(From::LightsByKernel, path, to, path.throughput);
      if (at.diffuse != glm::vec3(0.0f)) add(From::Base, path, to, path.throughput * at.diffuse);
    }
    const HighlightSample next = sampleHighlight(at, to, choices(path.number, reflection));
    path.throughput *= next.weight;
    const glm::vec3 place = (1.0f - u - v) * a + u * b + v * c;
    const float size = std::sqrt(0.5f * glm::length(glm::cross(b - a, c - a)));
    path.from = place + standOff(place, size) * at.geometric;
    path.ray = next.ray, path.along = next.direction;
    return path.throughput != glm::vec3(0.0f);
  }

  // Adds the light that the path finds. Returns true if it is at another mirror.
  bool meet(Path& path, const FirstHit& met) {
    if (!met.any()) {
      add(MirroredLight::From::Sky, path, path.along, path.throughput);
      return false;
    }
    if (met.back) return false;
    path.along = path.ray;
    path.hit = {.triangle = met.triangle,
                .ray = path.hit.ray,
                .u = GatherHit::unorm(met.u),
                .v = GatherHit::unorm(met.v)};
    if (mirrors_.isSharp(path.hit)) return true;
    if (mirrors_.brdfs_.glossy(met.triangle)) {
      add(MirroredLight::From::Kernel, path, -path.along, path.throughput);
      return false;
    }
    const glm::vec3 passed =
        path.throughput * mirrors_.colors_.albedo(met.triangle, path.hit.uAt(), path.hit.vAt());
    if (path.from_layer) {
      add(MirroredLight::From::Diffuse, path, -path.along, passed);
      return false;
    }
    path.hit.setAlbedo(passed);
    if (!isBlack(path.hit)) hits_.hits[path.index] = path.hit;
    return false;
  }

  const MirrorPaths& mirrors_;
  RangeHits& hits_;
  std::vector<Path> paths_;
  std::vector<Found> found_;
};

void MirrorPaths::follow(std::size_t first_sample, const RayDirection& direction,
                         std::span<const glm::vec3> passed, RangeHits& hits) const {
  Walk walk(*this, hits);
  std::vector<std::uint8_t> begun(hits.hits.size(), 0);
  bool any = false;
  for (std::size_t s = 0; s + 1 < hits.offsets.size(); ++s) {
    const std::uint32_t number = scattered(first_sample + s);
    for (std::uint32_t h = hits.offsets[s]; h < hits.offsets[s + 1]; ++h) {
      GatherHit& hit = hits.hits[h];
      const glm::vec3 before = passed.empty() ? glm::vec3(1.0f) : passed[h];
      const bool layered = brdfs_.layered(hit.triangle), sharp = isSharp(hit),
                 dimmed = before != glm::vec3(1.0f) && brdfs_.glossy(hit.triangle);
      Walk::Start at{h, s, number + hit.ray, glm::vec3(0.0f), before};
      if (layered || sharp || dimmed) at.along = direction(s, hit.ray);
      if (layered) {
        const float reflected = leaveBase(at.along, hit);
        const float chance = std::min(kPathsInLayer * reflected, 1.0f);
        if (evenly(at.number) < chance) {
          any = true;
          at.throughput /= chance;
          walk.start(at, /*from_layer=*/true);
        }
      } else if (sharp || dimmed) {
        begun[h] = 1, any = true;
        if (sharp)
          walk.start(at, /*from_layer=*/false);
        else
          walk.end(at);
      }
      if (!passed.empty()) hit.setAlbedo(before * hit.albedoAt());
    }
  }
  if (!any) return;
  walk.follow();
  walk.finish(begun);
}

}  // namespace lambent::baker
