#include "runtime/lighting/capture_sky.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <future>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include "lambent_lighting_embedded.hpp"
#include "runtime/sh/cube_map.hpp"

namespace lambent::lighting {

namespace {

constexpr gpu::FindText kShaders[] = {&embedded::lambent_lighting::find};

// As in capture_sky.comp.
constexpr GLint kLightFromWorld = 0, kSize = 1, kSubsamples = 2, kLevel = 3, kConstant = 4, kScale = 5;
constexpr std::uint32_t kLargestProbeCube = 512;

// At least a texel of the cube per texel of the probe, as far as memory goes; a power of two for the mip
// maps.
std::uint32_t probeCubeSize(const Environment& environment) {
  std::uint32_t size = 1;
  for (const spec::Probe& probe : environment.probes()) {
    const std::uint32_t width = probe.image.width;
    const std::uint32_t wanted = probe.layout == sh::ImageLayout::VerticalCross ? width / 3 : width / 4;
    size = std::max(size, std::bit_ceil(std::clamp(wanted, 16u, kLargestProbeCube)));
  }
  return size;
}

// Means over 2 x 2 places of each texel.
std::vector<glm::vec4> faceTexels(const Environment& environment, int face, std::uint32_t size) {
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
          for (const spec::Probe& probe : environment.probes()) sum += 0.25f * spec::radiance(probe, dir);
        }
      texels.emplace_back(sum, 0.0f);
    }
  return texels;
}

}  // namespace

Result<CaptureSky> CaptureSky::create(const CaptureOptions& options, const Environment& environment) {
  CaptureSky sky;
  sky.options_ = options;
  Result<gpu::Program> program =
      gpu::Program::create("capture sky", {{GL_COMPUTE_SHADER, "capture_sky.comp"}}, kShaders);
  if (!program) return failAgain(program.error());
  sky.program_ = std::move(*program);
  const std::uint32_t size = probeCubeSize(environment);
  sky.probes_ = gpu::Texture(
      "capture probes",
      {.format = GL_RGBA32F, .width = size, .height = size, .levels = std::bit_width(size), .cube = true});
  std::vector<std::future<std::vector<glm::vec4>>> faces;
  for (int face = 0; face < 6; ++face)
    faces.push_back(
        std::async(std::launch::async, [&, face] { return faceTexels(environment, face, size); }));
  for (int face = 0; face < 6; ++face)
    glTextureSubImage3D(sky.probes_.id(), 0, 0, 0, face, static_cast<GLsizei>(size),
                        static_cast<GLsizei>(size), 1, GL_RGBA, GL_FLOAT,
                        faces[static_cast<std::size_t>(face)].get().data());
  glGenerateTextureMipmap(sky.probes_.id());
  sky.sampler_ = gpu::Sampler(GL_CLAMP_TO_EDGE, GL_CLAMP_TO_EDGE, GL_LINEAR, GL_LINEAR_MIPMAP_LINEAR);
  sky.texels_ = gpu::Buffer("capture sky", std::size_t{6} * options.size * options.size * sizeof(glm::vec4));
  spec::DistantLights no_suns;
  no_suns.probes = environment.probes();
  no_suns.constant = environment.constant();
  sky.unturned_ = no_suns.lightVector();
  return sky;
}

bool CaptureSky::update(const Environment& environment, gpu::Counters& counters) {
  if (version_ == environment.version()) return false;
  makeTurned(environment.worldFromLight(), environment.constant());
  version_ = environment.version();
  ++counters.dispatches;
  return true;
}

void CaptureSky::makeTurned(const glm::mat3& world_from_light, const glm::vec3& constant_radiance) {
  version_ = 0;
  const glm::mat3 light_from_world = glm::transpose(world_from_light);
  const float texels_of_subsample =
      static_cast<float>(probes_.desc().width) / static_cast<float>(options_.size * options_.subsamples);
  program_.use();
  glUniformMatrix3fv(kLightFromWorld, 1, GL_FALSE, glm::value_ptr(light_from_world));
  glUniform1ui(kSize, options_.size);
  glUniform1ui(kSubsamples, options_.subsamples);
  glUniform1f(kLevel, std::max(0.0f, std::log2(texels_of_subsample)));
  glUniform3fv(kConstant, 1, glm::value_ptr(constant_radiance));
  glUniform3f(kScale, 1.0f, 1.0f, 1.0f);
  probes_.bind(0);
  glBindSampler(0, sampler_.id());
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  texels_.bindStorage(0);
  glDispatchCompute((6 * options_.size * options_.size + 63) / 64, 1, 1);
  glBindSampler(0, 0);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

sh::LightVector CaptureSky::light(const Environment& environment) const {
  return spec::turned(unturned_, environment.turnDegrees()).truncated(options_.order);
}

}  // namespace lambent::lighting
