#include "runtime/lighting/sky.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <future>
#include <span>
#include <string>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/packing.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include "lambent_lighting_embedded.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/capture.hpp"
#include "runtime/lighting/capture_shared.h"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/image_layout.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::lighting {

const gpu::FindText kLightingShaders[1] = {&embedded::lambent_lighting::find};

namespace {

constexpr float kLargestHalf = 65504.0f;
constexpr std::uint32_t kLargestSkyCube = 1024;

// These are the binding and the uniform locations of sky.frag.
constexpr GLuint kBindSkyDiscs = 0;
constexpr GLint kWorldFromClip = 0, kLightFromWorld = 1, kDiscCount = 2, kPixelAngle = 3, kShares = 4;
struct DiscRecord {
  glm::vec4 direction_and_radius;  // lights' own frame; w: radius in radians
  glm::vec3 radiance;
  float set;
};
static_assert(sizeof(DiscRecord) == 32);

std::vector<std::uint64_t> faceTexels(std::span<const spec::EnvironmentMap* const> environment_maps,
                                      glm::vec3 constant, int face, std::uint32_t size) {
  std::vector<std::uint64_t> texels;
  texels.reserve(std::size_t{size} * size);
  for (std::uint32_t y = 0; y < size; ++y)
    for (std::uint32_t x = 0; x < size; ++x) {
      const glm::vec3 dir =
          sh::cubeTexelDirection(static_cast<int>(size), face, static_cast<int>(x), static_cast<int>(y));
      glm::vec3 sum = constant;
      for (const spec::EnvironmentMap* environment_map : environment_maps)
        sum += spec::radiance(*environment_map, dir);
      texels.push_back(glm::packHalf4x16(glm::vec4(glm::min(sum, glm::vec3(kLargestHalf)), 0.0f)));
    }
  return texels;
}

// Returns a size with about one texel of a cube map per texel of the environment maps; a constant needs only
// one. The size is a power of two because mip levels are read, and halving an odd size drops a row of texels,
// in which a lamp may stand.
std::uint32_t cubeSizeFor(std::span<const spec::EnvironmentMap* const> environment_maps) {
  std::uint32_t size = 1;
  for (const spec::EnvironmentMap* environment_map : environment_maps) {
    const std::uint32_t width = environment_map->image.width;
    const std::uint32_t wanted =
        environment_map->layout == sh::ImageLayout::VerticalCross ? width / 3 : width / 4;
    size = std::max(size, std::bit_ceil(std::clamp(wanted, 16u, kLargestSkyCube)));
  }
  return size;
}

// Resamples environment maps and a constant, in their own frame, with about one texel of the cube per texel
// of the environment maps and a thread for each face.
gpu::Texture skyCube(std::span<const spec::EnvironmentMap* const> environment_maps, glm::vec3 constant,
                     bool mip_levels = false) {
  const std::uint32_t size = cubeSizeFor(environment_maps);
  gpu::Texture cube("sky", {.format = GL_RGBA16F,
                            .width = size,
                            .height = size,
                            .levels = mip_levels ? static_cast<std::uint32_t>(std::bit_width(size)) : 1u,
                            .cube = true});
  std::vector<std::future<std::vector<std::uint64_t>>> faces;
  for (int face = 0; face < 6; ++face)
    faces.push_back(
        std::async(std::launch::async, [=] { return faceTexels(environment_maps, constant, face, size); }));
  for (int face = 0; face < 6; ++face)
    glTextureSubImage3D(cube.id(), 0, 0, 0, face, static_cast<GLsizei>(size), static_cast<GLsizei>(size), 1,
                        GL_RGBA, GL_HALF_FLOAT, faces[static_cast<std::size_t>(face)].get().data());
  if (mip_levels) glGenerateTextureMipmap(cube.id());
  glTextureParameteri(cube.id(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(cube.id(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  return cube;
}

}  // namespace

Result<Sky> Sky::create(const Environment& environment) {
  Sky sky;
  Result<gpu::Program> program = gpu::Program::create(
      "sky", {{GL_VERTEX_SHADER, "sky.vert"}, {GL_FRAGMENT_SHADER, "sky.frag"}}, kLightingShaders);
  if (!program) return failAgain(program.error());
  sky.program_ = std::move(*program);
  sky.no_vertices_ = gpu::VertexArray("sky");
  sky.update(environment);
  return sky;
}

bool Sky::update(const Environment& environment) {
  if (upToDate(environment)) return false;
  lights_ = environment.lightsVersion();
  std::vector<DiscRecord> discs;
  for (std::size_t i = 0; i < Environment::kSets; ++i) {
    const Environment::Part shown = environment.shownOf(i);
    if (pictures_ != environment.picturesVersion())
      cubes_[i] = skyCube(shown.environment_maps, shown.constant);
    for (const Disc& disc : shown.discs)
      discs.push_back({{disc.direction, disc.radius_rad}, disc.radiance, static_cast<float>(i)});
  }
  pictures_ = environment.picturesVersion();
  disc_count_ = static_cast<std::uint32_t>(discs.size());
  discs_.assign(std::span<const DiscRecord>(discs));
  return true;
}

void Sky::draw(const Environment& environment, const glm::mat4& view_from_world,
               const glm::mat4& clip_from_view, std::uint32_t picture_height, gpu::Counters& counters) const {
  // Only the rotation is used, so that precision does not depend on where the scene stands.
  const glm::mat4 rotation = glm::mat4(glm::mat3(view_from_world));
  const glm::mat4 world_from_clip = glm::inverse(clip_from_view * rotation);
  const glm::mat3 light_from_world = glm::transpose(environment.worldFromLight());
  program_.use();
  glUniformMatrix4fv(kWorldFromClip, 1, GL_FALSE, glm::value_ptr(world_from_clip));
  glUniformMatrix3fv(kLightFromWorld, 1, GL_FALSE, glm::value_ptr(light_from_world));
  glUniform1ui(kDiscCount, disc_count_);
  glUniform1f(kPixelAngle, 2.0f / (clip_from_view[1][1] * static_cast<float>(picture_height)));
  glUniform2f(kShares, environment.shareOf(0), environment.shareOf(1));
  for (GLuint i = 0; i < Environment::kSets; ++i) {
    cubes_[i].bind(i);
    glBindSampler(i, 0);
  }
  discs_.bindStorage(kBindSkyDiscs);
  glBindVertexArray(no_vertices_.id());
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  glDepthFunc(GL_LEQUAL);
  glDisable(GL_CULL_FACE);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  ++counters.draws;
  ++counters.draw_calls;
}

namespace {

using sh::kPi;
constexpr int kSteps = 16384;

double shape(double alpha, double cos_theta) {
  const double half_squared = 0.5 * (1.0 + cos_theta);  // cos² of half the angle
  const double root = half_squared * (alpha * alpha - 1.0) + 1.0;
  return std::max(cos_theta, 0.0) / (root * root);
}

// Returns a quadrature node for theta in 0..pi/2. Nodes are dense near 0, where narrow lobes are.
double thetaAt(double u) {
  return 0.5 * kPi * u * u * u;
}

}  // namespace

float ReflectedLobe::density(float cos_theta) const {
  return scale * static_cast<float>(shape(alpha, cos_theta));
}

float roughnessOfLevel(std::uint32_t level, std::uint32_t levels) {
  return std::pow(static_cast<float>(level) / static_cast<float>(levels - 1), 1.5f);
}

ReflectedLobe makeReflectedLobe(float roughness) {
  ReflectedLobe lobe;
  if (!(roughness > 0.0f)) {
    lobe.bands.fill(1.0f);
    return lobe;
  }
  lobe.alpha = std::max(roughness * roughness, 1e-3f);
  std::vector<double> shares(kSteps);
  double all = 0.0;
  std::array<double, sh::kMaxOrder> bands{};
  for (int i = 0; i < kSteps; ++i) {
    const double low = thetaAt(static_cast<double>(i) / kSteps), high = thetaAt((i + 1.0) / kSteps);
    const double theta = thetaAt((i + 0.5) / kSteps), cosine = std::cos(theta);
    const double ring = 2.0 * kPi * (std::cos(low) - std::cos(high));
    const double share = ring * shape(lobe.alpha, cosine);
    shares[static_cast<std::size_t>(i)] = share;
    all += share;
    for (int l = 0; l < sh::kMaxOrder; ++l)
      bands[static_cast<std::size_t>(l)] += share * sh::legendre(l, cosine);
  }
  lobe.scale = static_cast<float>(1.0 / all);
  for (std::size_t l = 0; l < bands.size(); ++l) lobe.bands[l] = static_cast<float>(bands[l] / all);
  double passed = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    passed += shares[static_cast<std::size_t>(i)] / all;
    while (static_cast<int>(lobe.angles_rad.size()) < kLobeShares &&
           passed >= (static_cast<double>(lobe.angles_rad.size()) + 0.5) / kLobeShares)
      lobe.angles_rad.push_back(static_cast<float>(thetaAt((i + 0.5) / kSteps)));
  }
  lobe.angles_rad.resize(kLobeShares, static_cast<float>(0.5 * kPi));
  return lobe;
}

namespace {

constexpr std::uint32_t kLargestSize = 256, kLeastSize = 64;  // kLeastSize allows kReflectedLevels levels
// Returns the number of samples of the lobe that look at the sky: more where the lobe is wide and texels are
// few.
int sharesOf(std::uint32_t level) {
  return level <= 1 ? 32 : level == 2 ? 64 : kLobeShares;
}

// These are the uniform locations of prefiltered_environment.comp.
constexpr GLint kSize = 0, kLobe = 1, kReflectedSkyShares = 2, kReflectedDiscCount = 3;

// Returns the sky with all mip levels, so that wide lookups are cheap.
gpu::Texture withLevels(const gpu::Texture& sky, const gpu::Program& program, gpu::Counters& counters) {
  const std::uint32_t size = sky.desc().width;
  gpu::Texture weighted("sky to reflect", {.format = GL_RGBA16F,
                                           .width = size,
                                           .height = size,
                                           .levels = static_cast<std::uint32_t>(std::bit_width(size)),
                                           .cube = true});
  program.use();
  sky.bind(0);
  glBindSampler(0, 0);
  glUniform1i(kSize, static_cast<GLint>(size));
  glBindImageTexture(0, weighted.id(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_RGBA16F);
  const std::uint32_t groups = (size + kReflectedGroup - 1) / kReflectedGroup;
  glDispatchCompute(groups, groups, 6);
  ++counters.dispatches;
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
  glGenerateTextureMipmap(weighted.id());
  glTextureParameteri(weighted.id(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTextureParameteri(weighted.id(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  return weighted;
}

// Key lights wider than this are pieces of something with a shape of its own.
constexpr float kWideKey_rad = 0.06f;

bool hasWideKeys(const Environment& environment) {
  float wide = 0.0f, all = 0.0f;
  for (std::size_t set = 0; set < Environment::kSets; ++set)
    for (const Disc& key : environment.keysOf(set)) {
      const float flux = key.radius_rad * key.radius_rad * (key.radiance.r + key.radiance.g + key.radiance.b);
      all += flux;
      if (key.radius_rad > kWideKey_rad) wide += flux;
    }
  return wide > 0.5f * all;
}

struct PrefilterSource {
  const gpu::Texture& sky;  // in the lights' own frame
  std::span<const Disc> discs;
  bool pictured = false;  // false: everything that is not a disc is constant
  const gpu::Program &program, &weigh;
  std::span<const ReflectedLobe> lobes;
};

// Makes P(L) of one set of lights, with roughness along the mip levels.
gpu::Texture prefilter(const PrefilterSource& from, gpu::Counters& counters) {
  gpu::Table angles("lobe"), discs_table("reflected discs");
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  const gpu::Texture source = withLevels(from.sky, from.weigh, counters);
  // Suns are sharper than environment maps.
  const std::uint32_t size = from.discs.empty()
                                 ? std::clamp(std::bit_ceil(source.desc().width), kLeastSize, kLargestSize)
                                 : kLargestSize;
  gpu::Texture cube(
      "prefiltered environment",
      {.format = GL_RGBA16F, .width = size, .height = size, .levels = kReflectedLevels, .cube = true});
  glTextureParameteri(cube.id(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTextureParameteri(cube.id(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  std::vector<ReflectedDisc> discs;
  for (const Disc& disc : from.discs)
    discs.push_back({{disc.direction, disc.radius_rad}, {disc.radiance, 0.0f}});
  discs_table.assign(std::span<const ReflectedDisc>(discs));
  discs_table.bindStorage(kBindDiscs);
  from.program.use();
  source.bind(0);
  glBindSampler(0, 0);
  for (std::uint32_t level = 0; level < kReflectedLevels; ++level) {
    const ReflectedLobe& lobe = from.lobes[level];
    const std::uint32_t side = std::max(size >> level, 1u);
    angles.assign(std::span<const float>(lobe.angles_rad));
    angles.bindStorage(kBindLobe);
    glUniform1i(kSize, static_cast<GLint>(side));
    glUniform2f(kLobe, lobe.alpha, lobe.scale);
    glUniform1i(kReflectedSkyShares, from.pictured ? sharesOf(level) : 1);
    glUniform1ui(kReflectedDiscCount, static_cast<GLuint>(discs.size()));
    glBindImageTexture(0, cube.id(), static_cast<GLint>(level), GL_TRUE, 0, GL_WRITE_ONLY, GL_RGBA16F);
    const std::uint32_t groups = (side + kReflectedGroup - 1) / kReflectedGroup;
    glDispatchCompute(groups, groups, 6);
    ++counters.dispatches;
  }
  return cube;
}

}  // namespace

std::uint64_t PrefilteredEnvironment::sourceVersion(const Environment& environment) {
  return hasWideKeys(environment) ? environment.lightsVersion() : environment.restVersion();
}

Result<PrefilteredEnvironment> PrefilteredEnvironment::make(const Environment& environment, const Sky& sky,
                                                            gpu::Counters& counters) {
  Result<gpu::Program> program = gpu::Program::create(
      "prefiltered environment", {{GL_COMPUTE_SHADER, "prefiltered_environment.comp"}}, kLightingShaders);
  if (!program) return failAgain(program.error());
  Result<gpu::Program> weigh = gpu::Program::create(
      "reflected source", {{GL_COMPUTE_SHADER, "prefiltered_source.comp"}}, kLightingShaders);
  if (!weigh) return failAgain(weigh.error());
  PrefilteredEnvironment made;
  std::vector<ReflectedLobe> lobes;
  for (std::uint32_t level = 0; level < kReflectedLevels; ++level) {
    lobes.push_back(makeReflectedLobe(roughnessOfLevel(level, kReflectedLevels)));
    for (std::uint32_t l = 0; l < 8; ++l)
      made.values_.bands[2 * level + l / 4][static_cast<int>(l % 4)] = lobes.back().bands[l];
  }
  made.has_whole_ = hasWideKeys(environment);
  for (std::size_t set = 0; set < Environment::kSets; ++set) {
    const Environment::Part lights = environment.shownOf(set);
    const Environment::Part rest = environment.restOf(set);
    const bool parted = !environment.keysOf(set).empty();
    const gpu::Texture rest_sky = parted ? skyCube(rest.environment_maps, rest.constant) : gpu::Texture();
    const auto prefilterOf = [&](const gpu::Texture& source, std::span<const Disc> discs) {
      return prefilter({source, discs, !lights.environment_maps.empty(), *program, *weigh, lobes}, counters);
    };
    made.cubes_[set] = prefilterOf(parted ? rest_sky : sky.cube(set), rest.discs);
    if (made.has_whole_) made.whole_[set] = prefilterOf(sky.cube(set), lights.discs);
  }
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  return made;
}

void PrefilteredEnvironment::update(const Environment& environment, int order, sh::Window window,
                                    gpu::Counters& counters) {
  if (!changed_.renew(environment.version(), order, window)) return;
  values_.light_from_world = glm::mat4(glm::transpose(environment.worldFromLight()));
  values_.shares = {environment.shareOf(0), environment.shareOf(1), static_cast<float>(kReflectedLevels - 1),
                    has_whole_ ? 1.0f : 0.0f};
  const sh::LightVector light =
      sh::applyWindow(environment.restLight().truncated(order), window).truncated(sh::kMaxOrder);
  for (std::size_t k = 0; k < kReflectionCoefficients; ++k) values_.light[k] = glm::vec4(light.c[k], 0.0f);
  block_.assign(std::span<const ReflectionValues>(&values_, 1));
  counters.uploaded_bytes += sizeof(values_);
}

void PrefilteredEnvironment::bind() const {
  glBindBufferBase(GL_UNIFORM_BUFFER, kBindReflection, block_.buffer().id());
  cubes_[0].bind(kUnitFirstReflection);
  cubes_[1].bind(kUnitSecondReflection);
  (has_whole_ ? whole_ : cubes_)[0].bind(kUnitFirstWhole);
  (has_whole_ ? whole_ : cubes_)[1].bind(kUnitSecondWhole);
  glBindSampler(kUnitFirstWhole, 0);
  glBindSampler(kUnitSecondWhole, 0);
  glBindSampler(kUnitFirstReflection, 0);
  glBindSampler(kUnitSecondReflection, 0);
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
}

namespace {

using namespace capture;

// These are the uniform locations of capture_sky.comp.
constexpr GLint kSkyFromWorld = 0, kSkySize = 1, kSkySubsamples = 2, kLevels = 3, kConstant = 4,
                kSkyShares = 5;
constexpr GLint kSkyTexelCount = 0;  // as in capture_sky_light.comp

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
  sky.light_ = gpu::Buffer("capture sky light", coefficients * sizeof(glm::vec4));
  return sky;
}

void CaptureSky::takeLights(const Environment& environment) {
  if (lights_ == environment.restVersion()) return;
  lights_ = environment.restVersion();
  for (std::size_t i = 0; i < Environment::kSets; ++i)
    environment_maps_[i] =
        skyCube(environment.restOf(i).environment_maps, glm::vec3(0.0f), /*mip_levels=*/true);
}

bool CaptureSky::update(const Environment& environment, const gpu::Buffer& weights, gpu::Counters& counters) {
  if (version_ == environment.version()) return false;
  version_ = environment.version();
  takeLights(environment);
  const glm::mat3 light_from_world = glm::transpose(environment.worldFromLight());
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
  const std::uint32_t texel_count = 6 * options_.size * options_.size;
  glDispatchCompute((texel_count + kWorkGroupSize - 1) / kWorkGroupSize, 1, 1);
  for (GLuint i = 0; i < Environment::kSets; ++i) glBindSampler(i, 0);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  light_program_.use();
  glUniform1ui(kSkyTexelCount, texel_count);
  bindTables(weights);
  light_.bindStorage(kBindSkyLight);
  glDispatchCompute(1, 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  counters.dispatches += 2;
  return true;
}

void CaptureSky::bindTables(const gpu::Buffer& weights) {
  bindTable(texels_view_, kUnitSky, GL_RGBA32F, texels_);
  bindTable(weights_view_, kUnitWeights, GL_RGBA32F, weights);
}

}  // namespace lambent::lighting
