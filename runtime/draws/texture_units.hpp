// Binds the textures of surfaces, each with its sampler, to the units that the shaders name. A texture that
// has not arrived shows as white, a normal map as flat, a picture of anisotropy as that of the factors.
// Samplers are made once for each kind.
#pragma once

#include <map>
#include <tuple>

#include "runtime/draws/surface_record.hpp"
#include "runtime/gpu/objects.hpp"

namespace lambent::frame {

class TextureUnits {
 public:
  TextureUnits();

  void bind(const World& world, const SurfaceTextures& textures);
  // What glossy surfaces look into besides, and the table of b(v) of their bundle.
  void bindGlossy(const World& world, const SurfaceTextures& textures, std::uint32_t bundle,
                  std::int32_t table);
  void unbindSamplers() const;

 private:
  void bindOne(GLuint unit, const streaming::ResidentBundle* bundle, std::int32_t texture);

  gpu::Texture white_, flat_, along_tangent_;
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>, gpu::Sampler> samplers_;
};

}  // namespace lambent::frame
