// Makes media and marches rays through them by the shaders as C++, seen by a view whose axes are the world's.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <random>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "runtime/effects/volume/march.hpp"
#include "runtime/streaming/loader.hpp"
#include "tests/support/built_volume.hpp"
#include "tests/support/glsl/glsl.hpp"

namespace lambent::effects::volume::glsl {

using namespace lambent::glsl;

struct Medium {
  MarchRecord record{};
  Texels density, light;
  std::vector<float> block_maxima;
};

struct Scatter : Invocation {
#define LAMBENT_PRECISE
#include "as_cpp/volume_scatter.comp"
#undef LAMBENT_PRECISE
};

inline constexpr int kMostMedia = 3;

template <int LAMBENT_STOPS>
struct MarchText {
  std::span<const Medium> media;
  float densityAt(int v, vec3 place) { return media[static_cast<std::size_t>(v)].density.sample(place).r; }
  vec4 lightAt(int v, vec3 place) { return media[static_cast<std::size_t>(v)].light.sample(place); }
  float blockMaximumAt(uint block) { return media[block >> 24].block_maxima[block & 0xffffffu]; }
#define LAMBENT_VOLUMES kMostMedia
#define LAMBENT_BANDS 6
#include "as_cpp/volume_march.glsl"
#undef LAMBENT_VOLUMES
#undef LAMBENT_BANDS
};

}  // namespace lambent::effects::volume::glsl

namespace lambent::effects::volume::testing {

using glsl::Medium;
// One medium or several.
struct Media : std::span<const Medium> {
  Media(const Medium& one) : span(&one, 1) {}
  Media(const std::vector<Medium>& several) : span(several) {}
};
inline const float kInfinity = glsl::MarchText<1>::kInfinity;

// Describes a ray from `begin` to `end` metres, in view space.
struct RaySegment {
  glm::vec3 origin_vs, dir_vs;
  float begin = 0.0f, end = kInfinity;
};

// Returns scattered radiance (RGB) and optical depth (alpha) up to each of the stops, through up to three
// media.
template <std::size_t Stops>
std::array<glm::vec4, Stops> marchTo(std::array<float, Stops> stops, const Media& media,
                                     const RaySegment& ray, float step_voxels, float jitter) {
  using Text = glsl::MarchText<static_cast<int>(Stops)>;
  Text text{media};
  MarchRecord records[glsl::kMostMedia];
  typename Text::VolumeRay rays[glsl::kMostMedia];
  for (uint v = 0; v < glsl::kMostMedia; ++v) {
    records[v] = media[std::min<std::size_t>(v, media.size() - 1)].record;
    records[v].first_block = v << 24;
    rays[v] = text.enterVolume(records[v], ray.origin_vs, ray.dir_vs, ray.begin);
    if (v >= media.size()) rays[v].leave = -kInfinity;
  }
  glm::vec4 gathered[Stops];
  text.marchVolumes(records, rays, stops.data(), step_voxels, jitter, gathered);
  return std::to_array(gathered);
}

inline glm::vec4 march(const Media& media, const RaySegment& ray, float step_voxels = 0.5f,
                       float jitter = 1.0f) {
  return marchTo<1>({ray.end}, media, ray, step_voxels, jitter)[0];
}

// Writes the samples of a volume into the texture of its light.
inline void scatter(const ScatterRecord& record, std::span<const uint> voxels,
                    std::span<const glm::vec4> samples, std::span<const glm::vec4> lights,
                    glsl::Texels& out) {
  glsl::Scatter kernel;
  kernel.records = std::span(&record, 1);
  kernel.voxels = voxels;
  kernel.samples = samples;
  kernel.lights = lights;
  kernel.light_image = std::move(out);
  glsl::run(kernel, record.sample_count);
  out = std::move(kernel.light_image);
}

using lambent::testing::BuiltVolume;

inline streaming::ResidentVolume residentOf(const BuiltVolume& built) {
  streaming::ResidentVolume volume;
  volume.grid.size = built.size;
  volume.grid.group_from_grid = built.group_from_grid;
  volume.grid.density_max = built.density_max;
  volume.grid.albedo = built.albedo;
  volume.grid.g = built.g;
  volume.grid.transfer_size = built.transfer_size;
  volume.outputs = built.shape.outputs;
  return volume;
}

// Uses the density as coded, and the given light for each texel of the light texture with all slabs.
inline Medium mediumOf(const BuiltVolume& built,
                       const std::function<glm::vec4(const glm::uvec3& texel)>& light,
                       const glm::mat4& world_from_group = glm::mat4(1.0f),
                       const glm::mat4& view_from_world = glm::mat4(1.0f)) {
  Medium medium;
  medium.record = *describeMarch(residentOf(built), world_from_group, view_from_world);
  const std::vector<std::byte> codes = built.codes();
  medium.density.size = built.size;
  medium.density.values.clear();
  for (std::size_t i = 0; i < codes.size(); i += built.bits / 8) {
    auto code = std::to_integer<std::uint32_t>(codes[i]);
    if (built.bits == 16) code |= std::to_integer<std::uint32_t>(codes[i + 1]) << 8;
    medium.density.values.emplace_back(static_cast<float>(code) / (built.bits == 16 ? 65535.0f : 255.0f));
  }
  medium.block_maxima = streaming::blockMaxima(codes, built.bits, built.size);
  medium.light.size = medium.record.light_size;
  medium.light.values.clear();
  for (uint z = 0; z < medium.light.size.z; ++z)
    for (uint y = 0; y < medium.light.size.y; ++y)
      for (uint x = 0; x < medium.light.size.x; ++x) medium.light.values.push_back(light({x, y, z}));
  return medium;
}

inline glm::vec4 whiteLight(const glm::uvec3&) {
  return glm::vec4(1.0f);
}

// Returns a function of voxel coordinates with values 0..1: clumps with edges about two voxels wide, and
// holes between.
inline std::function<float(const glm::vec3&)> clumps(unsigned seed, float voxels) {
  std::mt19937 engine(seed);
  const auto number = [&](float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(engine);
  };
  std::vector<glm::vec4> balls;
  for (int i = 0; i < 12; ++i)
    balls.emplace_back(number(0.2f, 0.8f) * voxels, number(0.2f, 0.8f) * voxels, number(0.2f, 0.8f) * voxels,
                       number(0.06f, 0.22f) * voxels);
  return [balls](const glm::vec3& at) {
    float most = 0.0f;
    for (const glm::vec4& ball : balls) {
      const float inside = ball.w - glm::distance(at, glm::vec3(ball));
      const float ripple =
          0.6f + 0.4f * std::sin(1.1f * at.x) * std::sin(0.9f * at.y) * std::sin(1.3f * at.z);
      most = std::max(most, std::clamp(0.5f * inside, 0.0f, 1.0f) * ripple);
    }
    return most;
  };
}

}  // namespace lambent::effects::volume::testing
