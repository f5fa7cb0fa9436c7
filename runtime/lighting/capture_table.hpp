// Presents storage buffers as buffer textures to shaders that fetch whole vectors at distant places.
#pragma once

#include "runtime/gpu/objects.hpp"

namespace lambent::lighting::capture {

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
