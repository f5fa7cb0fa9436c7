#include "runtime/lighting/capture_sky.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <future>
#include <span>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include "runtime/lighting/capture_shared.h"
#include "runtime/lighting/sky.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/image_layout.hpp"

namespace lambent::lighting {

namespace {

using namespace capture;

// These are the uniform locations of capture_sky.comp.
constexpr GLint kSkyFromWorld = 0, kSkySize = 1, kSkySubsamples = 2, kLevels = 3, kConstant = 4,
                kSkyShares = 5;
constexpr GLint kSkyTexelCount = 0;  // as in capture_sky_light.comp
constexpr std::uint32_t kLargestProbeCube = 512;

// Returns a power of two, for the mip maps, that gives at least a texel of the cube per texel of the
// environment map unless that exceeds the largest size.
std::uint32_t probeCubeSize(const std::vector<const spec::EnvironmentMap*>& environment_maps) {
  std::uint32_t size = 1;
  for (const spec::EnvironmentMap* environment_map : environment_maps) {
    const std::uint32_t width = environment_map->image.width;
    const std::uint32_t wanted =
        environment_map->layout == sh::ImageLayout::VerticalCross ? width / 3 : width / 4;
    size = std::max(size, std::bit_ceil(std::clamp(wanted, 16u, kLargestProbeCube)));
  }
  return size;
}

// Each texel is the mean over 2 x 2 places in it.
std::vector<glm::vec4> meanFaceTexels(const std::vector<const spec::EnvironmentMap*>& environment_maps,
                                      int face, std::uint32_t size) {
  constexpr double kPlaces[] = {0.25, 0.75};
  std::vector<glm::vec4> texels;
  texels.reserve(std::size_t{size} * size);
  for (std::uint32_t y = 0; y < size; ++y)
    for (std::uint32_t x = 0; x < size; ++x) {
      glm::vec3 sum(0.0f);
      for (const double v : kPlaces)
        for (const double u : kPlaces) {
          const glm::vec3 dir(
              glm::normalize(sh::cubeFaceDirection(face, 2 * (x + u) / size - 1, 2 * (y + v) / size - 1)));
          for (const spec::EnvironmentMap* environment_map : environment_maps)
            sum += 0.25f * spec::radiance(*environment_map, dir);
        }
      texels.emplace_back(sum, 0.0f);
    }
  return texels;
}

// Makes the cube in the lights' own frame, with mip maps.
gpu::Texture probeCube(const std::vector<const spec::EnvironmentMap*>& environment_maps) {
  const std::uint32_t size = probeCubeSize(environment_maps);
  gpu::Texture cube("capture environment maps", {.format = GL_RGBA32F,
                                                 .width = size,
                                                 .height = size,
                                                 .levels = static_cast<std::uint32_t>(std::bit_width(size)),
                                                 .cube = true});
  std::vector<std::future<std::vector<glm::vec4>>> faces;
  for (int face = 0; face < 6; ++face)
    faces.push_back(std::async(std::launch::async, [&environment_maps, face, size] {
      return meanFaceTexels(environment_maps, face, size);
    }));
  for (int face = 0; face < 6; ++face)
    glTextureSubImage3D(cube.id(), 0, 0, 0, face, static_cast<GLsizei>(size), static_cast<GLsizei>(size), 1,
                        GL_RGBA, GL_FLOAT, faces[static_cast<std::size_t>(face)].get().data());
  glGenerateTextureMipmap(cube.id());
  return cube;
}

}  // namespace

Result<CaptureSky> CaptureSky::create(const CaptureOptions& options, const Environment& environment) {
  CaptureSky sky;
  sky.options_ = options;
  const gpu::Define order{"ORDER", std::to_string(options.order)};
  const std::span<const gpu::Define> defines(&order, 1);
  Result<gpu::Program> program = gpu::Program::create(
      "capture sky", {{GL_COMPUTE_SHADER, "capture_sky.comp"}}, kLightingShaders, defines);
  if (!program) return failAgain(program.error());
  sky.program_ = std::move(*program);
  program = gpu::Program::create("capture sky light", {{GL_COMPUTE_SHADER, "capture_sky_light.comp"}},
                                 kLightingShaders, defines);
  if (!program) return failAgain(program.error());
  sky.light_program_ = std::move(*program);
  sky.takeLights(environment);
  sky.sampler_ = gpu::Sampler(GL_CLAMP_TO_EDGE, GL_CLAMP_TO_EDGE, GL_LINEAR, GL_LINEAR_MIPMAP_LINEAR);
  const std::size_t texels = std::size_t{6} * options.size * options.size,
                    coefficients = static_cast<std::size_t>(sh::coefficientCount(options.order));
  sky.texels_ = gpu::Buffer("capture sky", texels * sizeof(glm::vec4));
  sky.weights_ = gpu::Buffer("capture sky weights", texels * ((coefficients + 3) / 4) * sizeof(glm::vec4));
  sky.light_ = gpu::Buffer("capture sky light", coefficients * sizeof(glm::vec4));
  return sky;
}

void CaptureSky::takeLights(const Environment& environment) {
  if (lights_ == environment.restVersion()) return;
  lights_ = environment.restVersion();
  for (std::size_t i = 0; i < Environment::kSets; ++i)
    environment_maps_[i] = probeCube(environment.restOf(i).environment_maps);
}

bool CaptureSky::update(const Environment& environment, const gpu::Buffer& weights, gpu::Counters& counters) {
  if (version_ == environment.version()) return false;
  makeTurned(environment, environment.worldFromLight(), weights);
  version_ = environment.version();
  counters.dispatches += 2;
  return true;
}

void CaptureSky::makeTurned(const Environment& environment, const glm::mat3& world_from_light,
                            const gpu::Buffer& weights) {
  takeLights(environment);
  version_ = 0;
  const glm::mat3 light_from_world = glm::transpose(world_from_light);
  // Two subsamples span a texel: with one, the triangles of the linear filter would not add up evenly over a
  // turned environment map, and a sun of one texel would flicker by several per cent.
  const auto levelOf = [&](const gpu::Texture& environment_maps) {
    return std::max(0.0f, std::log2(2.0f * static_cast<float>(environment_maps.desc().width) /
                                    static_cast<float>(options_.size * options_.subsamples)));
  };
  glm::vec3 constant(0.0f);
  std::array<float, Environment::kSets> shares{};
  for (std::size_t i = 0; i < Environment::kSets; ++i) {
    constant += environment.shareOf(i) * environment.set(i).constant;
    if (!environment.set(i).environment_maps.empty()) shares[i] = environment.shareOf(i);
  }
  program_.use();
  glUniformMatrix3fv(kSkyFromWorld, 1, GL_FALSE, glm::value_ptr(light_from_world));
  glUniform1ui(kSkySize, options_.size);
  glUniform1ui(kSkySubsamples, options_.subsamples);
  glUniform2f(kLevels, levelOf(environment_maps_[0]), levelOf(environment_maps_[1]));
  glUniform3fv(kConstant, 1, glm::value_ptr(constant));
  glUniform2f(kSkyShares, shares[0], shares[1]);
  for (GLuint i = 0; i < Environment::kSets; ++i) {
    environment_maps_[i].bind(i);
    glBindSampler(i, sampler_.id());
  }
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  texels_.bindStorage(kBindSky);
  weights.bindStorage(kBindWeights);
  weights_.bindStorage(kBindSkyWeights);
  const std::uint32_t texel_count = 6 * options_.size * options_.size;
  glDispatchCompute((texel_count + kWorkGroupSize - 1) / kWorkGroupSize, 1, 1);
  for (GLuint i = 0; i < Environment::kSets; ++i) glBindSampler(i, 0);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  light_program_.use();
  glUniform1ui(kSkyTexelCount, texel_count);
  bindTables();
  light_.bindStorage(kBindSkyLight);
  glDispatchCompute(1, 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
}

void CaptureSky::bindTables() {
  bindTable(texels_view_, kUnitSky, GL_RGBA32F, texels_);
  bindTable(weights_view_, kUnitSkyWeights, GL_RGBA32F, weights_);
}

}  // namespace lambent::lighting
