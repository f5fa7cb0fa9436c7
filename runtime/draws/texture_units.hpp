// Binds the textures of surfaces, each with its sampler, to the units that the shaders name. A texture that
// has not arrived shows as white, a normal map as flat, and an anisotropy texture as one that keeps the
// factors. One sampler is made per kind. Render thread only.
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
  // Binds the further textures of glossy surfaces, and the table of b(v) of their bundle.
  void bindGlossy(const World& world, const SurfaceTextures& textures, std::uint32_t bundle,
                  std::int32_t table);
  void unbindSamplers() const;

 private:
  void bindOne(GLuint unit, const streaming::ResidentBundle* bundle, std::int32_t texture);

  gpu::Texture white_, flat_, along_tangent_;
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>, gpu::Sampler> samplers_;
};

}  // namespace lambent::frame
