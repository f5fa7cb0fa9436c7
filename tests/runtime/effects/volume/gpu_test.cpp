// Compares the kernels with what they compute as C++, and tests what makes them run.
#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "tests/runtime/effects/volume/media.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::effects::volume {
namespace {

using namespace testing;

constexpr std::uint32_t kSide = 48;

// Shades volumes by the effects that do so, and draws them into a small picture.
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
        options(march_options) {
    march.set(options);
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
float viewZ(const spec::View& view, float depth) {
  const glm::mat4& p = view.clip_from_view;
  return p[2][3] != 0.0f ? -p[3][2] / (depth + p[2][2]) : (depth - p[3][2]) / p[2][2];
}
PixelRay rayOf(const spec::View& view, std::uint32_t x, std::uint32_t y) {
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

spec::View orbit(float azimuth, float distance = 2.5f) {
  return spec::orbitView(
      {.azimuth_deg = azimuth, .elevation_deg = 20.0f, .distance_radii = distance, .fov_deg = 45.0f},
      glm::vec3(-1.0f), glm::vec3(1.0f), 1.0f);
}
spec::View flat(float azimuth) {
  spec::View view = orbit(azimuth);
  view.clip_from_view = glm::ortho(-1.5f, 1.2f, -1.3f, 1.4f, 0.5f, 9.0f);
  return view;
}

BuiltVolume cloud(unsigned seed, std::uint32_t bits = 16, std::uint32_t outputs = 1) {
  BuiltVolume built;
  built.size = {26, 21, 33};
  built.bits = bits;
  built.group_from_grid =
      glm::scale(glm::translate(glm::mat4(1.0f), glm::vec3(-1.0f)), 2.0f / glm::vec3(26, 21, 33));
  const auto shape = clumps(seed, 26.0f);
  built.density_max = 6.0f;
  built.density = [=](const glm::vec3& at) { return 6.0f * shape(at); };
  built.albedo = {0.9f, 0.7f, 0.5f};
  built.g = outputs > 1 ? 0.6f : 0.0f;
  built.transfer_size = {5, 6, 7};
  built.has_sample = [](std::uint32_t voxel) { return voxel % 11 != 3; };
  built.shape = {.order = 3, .full_channels = 3, .outputs = outputs};
  if (outputs > 9)
    built.shape = {.order = 3, .outputs = outputs, .visibility_bands = 3 + transfer::bandsOf(outputs) - 1};
  built.transfer = [shape_of = built.shape, seed](std::uint32_t voxel) {
    std::mt19937 engine(seed * 1000 + voxel);
    std::vector<float> vector(shape_of.size());
    for (float& value : vector) value = std::uniform_real_distribution<float>(-0.2f, 0.4f)(engine);
    return vector;
  };
  return built;
}

std::vector<glm::vec4> pictureOfTwin(const Bench& bench, const spec::View& view, const glm::vec4& before,
                                     const std::vector<float>& depths) {
  std::vector<Medium> media;
  for (std::size_t v = 0; v < bench.built.size(); ++v) media.push_back(bench.mediumOf(v, view));
  std::vector<glm::vec4> texels;
  for (std::uint32_t y = 0; y < kSide; ++y)
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const PixelRay ray = rayOf(view, x, y);
      const float depth = depths[y * kSide + x];
      const float end = depth < 1.0f ? viewZ(view, 2.0f * depth - 1.0f) / ray.direction.z : kInfinity;
      const glm::vec4 found = march(media, {ray.origin, ray.direction, ray.begin, end});
      const float through = std::exp(-found.a);
      texels.push_back(
          glm::vec4(glm::vec3(found) + through * glm::vec3(before), 1.0f - through * (1.0f - before.a)));
    }
  return texels;
}

// Makes depths of a slanted wall in half of the picture; the other half is open.
std::vector<float> someDepths(const spec::View& view) {
  std::vector<float> depths;
  for (std::uint32_t y = 0; y < kSide; ++y)
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const float z = -4.0f - 0.03f * static_cast<float>(x) - 0.02f * static_cast<float>(y);
      const glm::vec4 clip = view.clip_from_view * glm::vec4(0.0f, 0.0f, z, 1.0f);
      depths.push_back(x < kSide / 2 ? 0.5f + 0.5f * clip.z / clip.w : 1.0f);
    }
  return depths;
}

void expectAlike(const std::vector<glm::vec4>& found, const std::vector<glm::vec4>& expected,
                 const std::string& what) {
  double change = 0.0, power = 0.0;
  float most = 0.0f;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const glm::vec4 apart = found[i] - expected[i];
    ASSERT_TRUE(std::isfinite(glm::dot(found[i], found[i]))) << what;
    change += glm::dot(apart, apart);
    power += glm::dot(expected[i], expected[i]);
    most = lambent::testing::larger(most, glm::length(apart));
  }
  EXPECT_LT(std::sqrt(change / power), 1e-3) << what;
  // GPUs interpolate with weights of 8 bits.
  EXPECT_LT(most, 0.03f) << what;
}

// Draws a white triangle in front of all media.
std::string_view wallText(std::string_view name) {
  if (name == "wall.vert")
    return "void main() { gl_Position = vec4(gl_VertexID == 1 ? 0.9 : -1.0, gl_VertexID == 2 ? 0.7 : -1.0, "
           "-0.9, "
           "1.0); }";
  if (name == "wall.frag") return "layout(location = 0) out vec4 color; void main() { color = vec4(1.0); }";
  return {};
}
constexpr gpu::FindText kWall[] = {&wallText};

}  // namespace

using VolumeGpu = lambent::testing::GpuTest;

TEST_F(VolumeGpu, MatchesItsTwinForOneVolumeAndSeveralThatOverlap) {
  const glm::mat4 turned = glm::translate(glm::mat4(1.0f), glm::vec3(0.5f, -0.2f, 0.3f)) *
                           glm::mat4_cast(glm::angleAxis(1.1f, glm::normalize(glm::vec3(1, 2, -1))));
  const glm::mat4 large =
      glm::scale(glm::translate(glm::mat4(1.0f), glm::vec3(-0.4f, 0.3f, 0.0f)), glm::vec3(1.4f));
  const std::vector<std::pair<std::string, std::vector<BuiltVolume>>> scenes = {
      {"8 bits", {cloud(1, 8)}},
      {"16 bits", {cloud(1, 16)}},
      {"nine outputs", {cloud(2, 16, 9)}},
      {"matrices", {cloud(3, 8, 16)}},
      {"matrices of five bands", {cloud(3, 16, 25)}},
      {"two", {cloud(4), cloud(5)}},
      {"three, one in bands", {cloud(6), cloud(7, 16, 9), cloud(8)}}};
  for (const auto& [name, volumes] : scenes) {
    Bench bench(volumes, {glm::mat4(1.0f), turned, large});
    bench.world_from_group.resize(volumes.size());
    bench.uploadAll();
    EXPECT_EQ(bench.shade(), volumes.size());
    for (const spec::View& view : {orbit(20.0f), orbit(200.0f, 0.4f), flat(120.0f)}) {
      const std::vector<float> depths = someDepths(view);
      const glm::vec4 before(0.3f, 0.6f, 1.2f, 0.5f);
      expectAlike(bench.picture(view, before, depths), pictureOfTwin(bench, view, before, depths), name);
    }
  }
}

TEST_F(VolumeGpu, BringsSamplesToTheirTexels) {
  for (const std::uint32_t outputs : {1u, 9u, 25u})
    for (const evaluate::TransferMode mode :
         {evaluate::TransferMode::Full, evaluate::TransferMode::Unshadowed}) {
      BuiltVolume built = cloud(9, 16, outputs);
      Bench bench({built});
      bench.uploadAll();
      bench.shade(mode);
      const streaming::ResidentGroup& group = bench.residency.groups()[0];
      const streaming::ResidentCell& cell = bench.residency.cells()[0];
      std::vector<glm::vec4> samples(bench.residency.samples().page(group.samples.page).byteCount() / 16);
      bench.residency.samples().page(group.samples.page).read(0, std::span(samples));
      const SlabLayout layout = slabLayoutOf(built.transfer_size, outputs);
      const bool open = mode == evaluate::TransferMode::Unshadowed && outputs <= 9;
      const ScatterRecord record{.first_output = cell.first_output,
                                 .first_voxel = 0,
                                 .sample_count = cell.sample_count,
                                 .outputs = outputs,
                                 .size = {5, 6, 7},
                                 .slabs_z = layout.slabs_z,
                                 .open = open ? 9u : 0u,
                                 .light = bench.lights.firstOf(0),
                                 .g = built.g,
                                 .pad = 0};
      glsl::Texels expected(layout.texture_size);
      const std::vector<uint> voxels = built.voxels();
      scatter(record, voxels, samples, bench.lights.coefficients(), expected);
      const Medium found = bench.mediumOf(0, orbit(0.0f));
      ASSERT_EQ(found.light.values.size(), expected.values.size());
      for (std::size_t i = 0; i < expected.values.size(); ++i)
        ASSERT_LT(glm::distance(found.light.values[i], expected.values[i]), 1e-5f) << outputs << " at " << i;
      if (mode == evaluate::TransferMode::Unshadowed) {
        // However it is stored: the light itself, its band l times g^l.
        const sh::LightVector& light = bench.environment.light();
        const glm::vec3 band_one = glm::vec3(expected.at({0, 0, outputs > 1 ? 2u * 7u : 0u}));
        const glm::vec3 wanted = outputs > 1 ? 0.6f * light.c[2] : 0.282094792f * light.c[0];
        EXPECT_LT(glm::distance(band_one, wanted), 1e-4f) << outputs;
      }
    }
}

TEST_F(VolumeGpu, WritesNothingUnlessSomethingChanged) {
  Bench bench({cloud(1), cloud(2, 16, 16)});
  bench.uploadAll();
  EXPECT_EQ(bench.shade(), 2u);
  EXPECT_EQ(bench.volume.shadedLast().volumes, 2u);
  EXPECT_EQ(bench.volume.shadedLast().slabs, 17u);
  EXPECT_EQ(bench.shade(), 0u);
  EXPECT_EQ(bench.counters.uploaded_bytes, 0u);
  bench.environment.setTurn(10.0f);
  EXPECT_EQ(bench.shade(), 2u);
  EXPECT_EQ(bench.shade(), 0u);
  EXPECT_EQ(bench.shade(evaluate::TransferMode::Shadowed), 2u);
  EXPECT_EQ(bench.shade(evaluate::TransferMode::Unshadowed), 2u);
  EXPECT_EQ(bench.shade(evaluate::TransferMode::Unshadowed), 0u);
  bench.environment.setTurn(20.0f);
  EXPECT_EQ(bench.shade(evaluate::TransferMode::Unshadowed), 2u) << "also where it shows the light itself";
}

TEST_F(VolumeGpu, ShowsTheLightItselfUntilTransferIsThere) {
  BuiltVolume built = cloud(1);
  built.transfer = nullptr;  // open in both blocks
  Bench bench({built});
  const auto parts = lambent::testing::partsOf(built, 0);
  EXPECT_EQ(bench.shade(), 0u) << "nothing of it is here";
  const spec::View view = orbit(10.0f);
  for (const glm::vec4& texel : bench.picture(view)) EXPECT_EQ(texel, glm::vec4(0.0f));
  bench.upload(parts[0]);
  EXPECT_EQ(bench.shade(), 0u) << "nowhere to put the light";
  bench.upload(parts[1]);
  EXPECT_EQ(bench.shade(), 1u);
  const std::vector<glm::vec4> before = bench.picture(view);
  bench.upload(parts[2]);
  EXPECT_EQ(bench.shade(), 1u);
  const std::vector<glm::vec4> after = bench.picture(view);
  float most = 0.0f, brightest = 0.0f;
  for (std::size_t i = 0; i < after.size(); ++i) {
    most = lambent::testing::larger(most, glm::distance(before[i], after[i]));
    brightest = lambent::testing::larger(brightest, after[i].g);
  }
  EXPECT_LT(most, 1e-4f);
  EXPECT_GT(brightest, 0.2f);
}

TEST_F(VolumeGpu, AnEmptyVolumeLeavesEveryPixelToTheLastBit) {
  for (const float density_max : {0.0f, 5.0f}) {
    BuiltVolume built = cloud(1);
    built.density_max = density_max;
    built.density = [](const glm::vec3&) { return 0.0f; };
    Bench bench({built});
    bench.uploadAll();
    bench.shade();
    const glm::vec4 before(0.1f, 1e-30f, 12345.678f, 0.3f);
    for (const glm::vec4& texel : bench.picture(orbit(30.0f), before)) ASSERT_EQ(texel, before);
    EXPECT_EQ(bench.march.drawnLast(), 0u);
  }
  // The volume is next to a full one, too, in pixels that only see its empty blocks.
  BuiltVolume corner = cloud(1);
  corner.density = [](const glm::vec3& at) { return glm::length(at) < 5.0f ? 3.0f : 0.0f; };
  Bench bench({corner});
  bench.uploadAll();
  bench.shade();
  const glm::vec4 before(0.1f, 0.7f, 3.0f, 0.3f);
  std::size_t same = 0, other = 0;
  for (const glm::vec4& texel : bench.picture(orbit(30.0f), before)) ++(texel == before ? same : other);
  EXPECT_GT(same, kSide * kSide / 2);
  EXPECT_GT(other, 20u);
}

TEST_F(VolumeGpu, StaysFiniteAtAnyDensityAndIsAFurnaceUnderWhiteLight) {
  for (const float density_max : {1e-6f, 1.0f, 100.0f, 1e6f}) {
    BuiltVolume built = cloud(1);
    const auto shape = clumps(1, 26.0f);
    built.density_max = density_max;
    built.density = [=](const glm::vec3& at) { return density_max * shape(at); };
    built.albedo = glm::vec3(1.0f);
    built.transfer = nullptr;
    Bench bench({built});
    bench.environment = *lighting::Environment::create({spec::ConstantLight{.radiance = glm::vec3(1.0f)}});
    bench.uploadAll();
    bench.shade();
    for (const spec::View& view : {orbit(30.0f), orbit(80.0f, 0.2f), flat(0.0f)})
      for (const glm::vec4& texel : bench.picture(view, glm::vec4(1.0f, 1.0f, 1.0f, 0.0f)))
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(texel[c], 1.0f, 1e-3f) << density_max;
  }
}

TEST_F(VolumeGpu, MoreVolumesThanOnePassTakesAreDrawnAll) {
  std::vector<BuiltVolume> many;
  std::vector<glm::mat4> stand;
  for (int i = 0; i < 10; ++i) {
    BuiltVolume built;
    built.transfer = nullptr;
    built.group_from_grid =
        glm::scale(glm::translate(glm::mat4(1.0f), glm::vec3(-0.1f)), glm::vec3(0.2f / 8.0f));
    built.density_max = 3.0f;
    built.density = [](const glm::vec3&) { return 3.0f; };
    many.push_back(built);
    stand.push_back(
        glm::translate(glm::mat4(1.0f), glm::vec3(0.0f, 0.0f, 0.2f * static_cast<float>(i) - 1.0f)));
  }
  Bench bench(many, stand);
  bench.environment = *lighting::Environment::create({spec::ConstantLight{.radiance = glm::vec3(1.0f)}});
  bench.uploadAll();
  bench.shade();
  spec::View view = flat(0.0f);
  view.view_from_world = glm::lookAt(glm::vec3(0, 0, 5), glm::vec3(0.0f), glm::vec3(0, 1, 0));
  view.clip_from_view = glm::ortho(-0.05f, 0.05f, -0.05f, 0.05f, 0.5f, 9.0f);
  const std::vector<glm::vec4> texels = bench.picture(view, glm::vec4(0.0f, 0.0f, 0.0f, 0.0f));
  EXPECT_EQ(bench.march.drawnLast(), 10u);
  EXPECT_NEAR(texels[kSide * kSide / 2].a, 1.0f - std::exp(-3.0f * 2.0f), 1e-4f);
  EXPECT_NEAR(texels[kSide * kSide / 2].g, 1.0f - std::exp(-3.0f * 2.0f), 1e-4f);
}

TEST_F(VolumeGpu, SamplesOfAPixelEachEndAtTheirOwnSurface) {
  // A wall's slanted edge is in front of a homogeneous medium: every sample sees either all of the medium or
  // none.
  BuiltVolume built;
  built.transfer = nullptr;
  built.density_max = 1.5f;
  built.density = [](const glm::vec3&) { return 1.5f; };
  built.albedo = glm::vec3(0.0f);
  Bench bench({built}, {}, /*precise=*/false, {.jitter = true});
  bench.uploadAll();
  bench.shade();
  const gpu::Texture color("color", {.format = GL_RGBA16F, .width = kSide, .height = kSide, .samples = 4});
  const gpu::Texture depth("depth",
                           {.format = GL_DEPTH_COMPONENT32F, .width = kSide, .height = kSide, .samples = 4});
  const gpu::Framebuffer whole("whole", color, &depth), target("target", color, nullptr);
  constexpr float kWhite[] = {1.0f, 1.0f, 1.0f, 0.0f}, kFar = 1.0f;
  glClearNamedFramebufferfv(whole.id(), GL_COLOR, 0, kWhite);
  glClearNamedFramebufferfv(whole.id(), GL_DEPTH, 0, &kFar);
  const auto wall = gpu::Program::create(
      "wall", {{GL_VERTEX_SHADER, "wall.vert"}, {GL_FRAGMENT_SHADER, "wall.frag"}}, kWall);
  ASSERT_TRUE(wall) << wall.error().line();
  const gpu::VertexArray no_vertices("wall");
  glBindFramebuffer(GL_FRAMEBUFFER, whole.id());
  glViewport(0, 0, kSide, kSide);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  wall->use();
  glBindVertexArray(no_vertices.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  spec::View view = flat(0.0f);
  view.view_from_world = glm::lookAt(glm::vec3(0, 0, 5), glm::vec3(0.0f), glm::vec3(0, 1, 0));
  view.clip_from_view = glm::ortho(-1.3f, 1.3f, -1.3f, 1.3f, 0.5f, 9.0f);
  bench.draw(view, {target, depth, {kSide, kSide}});
  // Resolved, a pixel is the mean of samples that are 1 (the wall) or exp(-3): only fifths of the way.
  const gpu::Texture resolved("resolved", {.format = GL_RGBA32F, .width = kSide, .height = kSide});
  const gpu::Framebuffer resolved_target("resolved", resolved, nullptr);
  glBlitNamedFramebuffer(target.id(), resolved_target.id(), 0, 0, kSide, kSide, 0, 0, kSide, kSide,
                         GL_COLOR_BUFFER_BIT, GL_NEAREST);
  std::vector<glm::vec4> texels(kSide * kSide);
  glGetTextureImage(resolved.id(), 0, GL_RGBA, GL_FLOAT,
                    static_cast<GLsizei>(texels.size() * sizeof(glm::vec4)), texels.data());
  const float behind = std::exp(-3.0f);
  std::size_t edges = 0;
  for (const glm::vec4& texel : texels) {
    const float quarters = 4.0f * (texel.g - behind) / (1.0f - behind);
    EXPECT_NEAR(quarters, std::round(quarters), 0.02f);
    if (quarters > 0.5f && quarters < 3.5f) ++edges;
  }
  EXPECT_GT(edges, 20u) << "the wall has an edge";
  EXPECT_NEAR(texels[5 * kSide + 5].g, 1.0f, 1e-3f);
  EXPECT_NEAR(texels[40 * kSide + 40].g, behind, 1e-3f);
}

TEST_F(VolumeGpu, JitterIsTheSameInEveryFrame) {
  Bench bench({cloud(2)}, {}, /*precise=*/false, {.step_voxels = 1.0f, .jitter = true});
  Bench plain({cloud(2)}, {}, /*precise=*/false, {.step_voxels = 1.0f, .jitter = false});
  for (Bench* each : {&bench, &plain}) {
    each->uploadAll();
    each->shade();
  }
  const std::vector<glm::vec4> first = bench.picture(orbit(40.0f));
  EXPECT_EQ(first, bench.picture(orbit(40.0f)));
  EXPECT_NE(first, plain.picture(orbit(40.0f)));
}

}  // namespace lambent::effects::volume
