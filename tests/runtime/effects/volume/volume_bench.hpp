// Shades volumes on the GPU by the effects that do so, and draws them into a small picture.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "tests/runtime/effects/volume/media.hpp"

namespace lambent::effects::volume::testing {

inline constexpr std::uint32_t kSide = 48;

struct Bench {
  std::vector<BuiltVolume> built;
  std::vector<glm::mat4> world_from_group;
  bundle::Description description;
  std::vector<bundle::Blob> blobs;
  streaming::Residency residency;
  lighting::GroupLights lights;
  evaluate::Samples samples;
  Volume volume;
  March march;
  MarchOptions options;
  std::vector<lighting::GroupPlace> places;
  lighting::Environment environment = *lighting::Environment::create(
      {spec::SunLight{
           .azimuth_deg = 30, .elevation_deg = 40, .angle_deg = 25, .radiance = {3.0f, 2.0f, 1.0f}},
       spec::ConstantLight{.radiance = {0.2f, 0.3f, 0.5f}}});
  gpu::Counters counters;

  explicit Bench(std::vector<BuiltVolume> volumes, std::vector<glm::mat4> stand = {}, bool precise = true,
                 const MarchOptions& march_options = {.step_voxels = 0.5f, .jitter = false})
      : built(std::move(volumes)),
        world_from_group(std::move(stand)),
        volume(precise),
        march(march_options),
        options(march_options) {
    world_from_group.resize(built.size(), glm::mat4(1.0f));
    for (std::size_t v = 0; v < built.size(); ++v) {
      lambent::testing::addVolume(description, blobs, built[v]);
      places.push_back({.world_from_group = glm::quat_cast(glm::mat3(world_from_group[v])),
                        .order = std::max(built[v].shape.order, 1u)});
    }
    EXPECT_TRUE(residency.add(description, 0));
  }

  void upload(const streaming::Ready& item) {
    const Result<void> done = residency.upload(0, item);
    EXPECT_TRUE(done) << done.error().line();
  }
  void uploadAll() {
    for (std::uint32_t v = 0; v < built.size(); ++v)
      for (const auto& item : lambent::testing::partsOf(built[v], v)) upload(item);
  }
  // Shades, and returns the number of dispatches of the volume effect alone.
  std::uint32_t shade(evaluate::TransferMode mode = evaluate::TransferMode::Full) {
    counters = {};
    gpu::Counters others;
    lights.update(environment, sh::Window::Off, places, others);
    const Result<void> shaded = samples.shade(residency, lights, mode, others);
    EXPECT_TRUE(shaded) << shaded.error().line();
    const Result<void> done = volume.shade(residency, {lights, samples}, mode, {}, counters);
    EXPECT_TRUE(done) << done.error().line();
    return counters.dispatches;
  }
  std::vector<PlacedVolume> placed() const {
    std::vector<PlacedVolume> list;
    for (std::uint32_t v = 0; v < built.size(); ++v) list.push_back({v, world_from_group[v]});
    return list;
  }
  // Draws over a picture of this colour with these depths, 0..1, one per sample of each pixel, rows from the
  // bottom.
  std::vector<glm::vec4> picture(const spec::View& view, const glm::vec4& before = glm::vec4(0.0f),
                                 const std::vector<float>& depths = {}) {
    const gpu::Texture color("color", {.format = GL_RGBA32F, .width = kSide, .height = kSide});
    const gpu::Texture depth("depth", {.format = GL_DEPTH_COMPONENT32F, .width = kSide, .height = kSide});
    std::vector<float> all = depths.empty() ? std::vector<float>(kSide * kSide, 1.0f) : depths;
    glTextureSubImage2D(depth.id(), 0, 0, 0, kSide, kSide, GL_DEPTH_COMPONENT, GL_FLOAT, all.data());
    glTextureParameteri(depth.id(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(depth.id(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    const gpu::Framebuffer target("target", color, nullptr);
    glClearNamedFramebufferfv(target.id(), GL_COLOR, 0, &before.x);
    draw(view, {target, depth, {kSide, kSide}});
    std::vector<glm::vec4> texels(kSide * kSide);
    glGetTextureImage(color.id(), 0, GL_RGBA, GL_FLOAT,
                      static_cast<GLsizei>(texels.size() * sizeof(glm::vec4)), texels.data());
    return texels;
  }
  void draw(const spec::View& view, const Picture& picture) {
    glViewport(0, 0, kSide, kSide);
    const Result<void> done = march.draw(residency, volume, placed(), view, picture, counters);
    EXPECT_TRUE(done) << done.error().line();
  }

  // Returns volume v with the texture that the GPU wrote.
  Medium mediumOf(std::size_t v, const spec::View& view) const {
    const glm::uvec3 size = slabLayoutOf(built[v].transfer_size, built[v].shape.outputs).texture_size;
    std::vector<glm::vec4> texels(std::size_t{size.x} * size.y * size.z);
    glGetTextureImage(volume.lightOf(v).id(), 0, GL_RGBA, GL_FLOAT,
                      static_cast<GLsizei>(texels.size() * sizeof(glm::vec4)), texels.data());
    return testing::mediumOf(
        built[v],
        [&](const glm::uvec3& texel) {
          return texels[texel.x + std::size_t{size.x} * (texel.y + std::size_t{size.y} * texel.z)];
        },
        world_from_group[v], view.view_from_world);
  }
};

struct PixelRay {
  glm::vec3 origin, direction;
  float begin;
};
inline float viewZ(const spec::View& view, float depth) {
  const glm::mat4& p = view.clip_from_view;
  return p[2][3] != 0.0f ? -p[3][2] / (depth + p[2][2]) : (depth - p[3][2]) / p[2][2];
}
inline PixelRay rayOf(const spec::View& view, std::uint32_t x, std::uint32_t y) {
  const glm::vec2 clip = (glm::vec2(x, y) + 0.5f) / static_cast<float>(kSide) * 2.0f - 1.0f;
  const glm::mat4& p = view.clip_from_view;
  PixelRay ray{glm::vec3(0.0f), glm::vec3(0, 0, -1), 0.0f};
  if (p[2][3] != 0.0f)
    ray.direction =
        glm::normalize(glm::vec3((clip.x + p[2][0]) / p[0][0], (clip.y + p[2][1]) / p[1][1], -1.0f));
  else
    ray.origin = glm::vec3((clip.x - p[3][0]) / p[0][0], (clip.y - p[3][1]) / p[1][1], 0.0f);
  ray.begin = viewZ(view, -1.0f) / ray.direction.z;
  return ray;
}

inline spec::View orbit(float azimuth, float distance = 2.5f) {
  return spec::orbitView(
      {.azimuth_deg = azimuth, .elevation_deg = 20.0f, .distance_radii = distance, .fov_deg = 45.0f},
      glm::vec3(-1.0f), glm::vec3(1.0f), 1.0f);
}
inline spec::View flat(float azimuth) {
  spec::View view = orbit(azimuth);
  view.clip_from_view = glm::ortho(-1.5f, 1.2f, -1.3f, 1.4f, 0.5f, 9.0f);
  return view;
}

}  // namespace lambent::effects::volume::testing
