// Binds the textures of surfaces, each with its sampler, to the units that the shaders name. A texture that
// has not arrived shows as white, a normal map as flat. Samplers are made once for each kind.
#pragma once

#include <map>
#include <tuple>

#include "runtime/frame/surface_record.hpp"
#include "runtime/gpu/objects.hpp"

namespace lambent::frame {

class TextureUnits {
 public:
  TextureUnits();

  void bind(const World& world, const SurfaceTextures& textures);
  void unbindSamplers() const;

 private:
  void bindOne(GLuint unit, const streaming::ResidentBundle* bundle, std::int32_t texture);

  gpu::Texture white_, flat_;
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>, gpu::Sampler> samplers_;
};

}  // namespace lambent::frame
