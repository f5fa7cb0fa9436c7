// Owns the sky as the light capture sees it: one small box-filtered cube map in world axes for all points,
// without suns. It takes an environment and provides, per texel (in the order of sh/image_layout.hpp), the
// radiance and the weights that project it to harmonics, and the projected sum. Two dispatches remake them
// when the environment was turned, faded or replaced. Render thread only. create() fails if a shader does not
// compile on this device.
#pragma once

#include <array>
#include <cstdint>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/capture_scene.hpp"
#include "runtime/lighting/environment.hpp"

namespace lambent::lighting::capture {

// Presents storage buffers as buffer textures to shaders that fetch whole vectors at distant places.

// Binds a view of the buffer. The view is created on first use and attached again on each call, since tables
// move when they grow.
inline void bindTable(gpu::Handle<gpu::TextureTraits>& texture, GLuint unit, GLenum format,
                      const gpu::Buffer& buffer) {
  if (!texture) {
    GLuint id = 0;
    glCreateTextures(GL_TEXTURE_BUFFER, 1, &id);
    texture = gpu::Handle<gpu::TextureTraits>(id);
  }
  glTextureBuffer(texture.id(), format, buffer.id());
  glBindTextureUnit(unit, texture.id());
  glBindSampler(unit, 0);
}

}  // namespace lambent::lighting::capture

namespace lambent::lighting {

class CaptureSky {
 public:
  CaptureSky() = default;
  static Result<CaptureSky> create(const CaptureOptions& options, const Environment& environment);

  // Remakes the cube if the environment changed, and returns whether it did. `weights` is
  // [texel][coefficient] from sh::cubeWeights.
  bool update(const Environment& environment, const gpu::Buffer& weights, gpu::Counters& counters);
  // Makes the cube with the environment maps turned by any rotation, for measurements. The next update()
  // remakes it.
  void makeTurned(const Environment& environment, const glm::mat3& world_from_light,
                  const gpu::Buffer& weights);
  // Binds the texels and weights that capture_project.comp reads.
  void bindTables();
  // Returns one vec4 per coefficient: the sum of texels times weights.
  const gpu::Buffer& light() const { return light_; }

 private:
  void takeLights(const Environment& environment);

  CaptureOptions options_;
  gpu::Program program_, light_program_;
  std::array<gpu::Texture, Environment::kSets> environment_maps_;  // light frame, float32, mip maps
  gpu::Sampler sampler_;
  gpu::Buffer texels_, weights_, light_;
  gpu::Handle<gpu::TextureTraits> texels_view_, weights_view_;
  std::uint64_t version_ = 0;  // version of the environment that the cube shows; 0: none yet
  std::uint64_t lights_ = 0;   // version of the lights in environment_maps_
};

}  // namespace lambent::lighting
