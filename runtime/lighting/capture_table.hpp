// Storage buffers as buffer textures, for shaders that fetch whole vectors far apart.
#pragma once

#include "runtime/gpu/objects.hpp"

namespace lambent::lighting::capture {

// Binds a view, made when it is first used; anew each time, since tables move when they grow.
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
