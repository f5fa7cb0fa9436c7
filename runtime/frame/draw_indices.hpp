// A vertex array whose one attribute, at location 0, steps once per instance through 0, 1, 2, ...: a draw's
// base instance comes back in the shader. gl_DrawID is not in OpenGL 4.5.
#pragma once

#include <cstdint>

#include "runtime/gpu/objects.hpp"

namespace lambent::frame {

class DrawIndices {
 public:
  explicit DrawIndices(std::string_view label) : vertices_(label) {}

  void reserve(std::size_t draw_count);
  // With `elements` as what indices are read from.
  void bind(const gpu::Buffer& elements) const {
    glBindVertexArray(vertices_.id());
    glVertexArrayElementBuffer(vertices_.id(), elements.id());
  }

 private:
  gpu::VertexArray vertices_;
  gpu::Buffer indices_;
};

}  // namespace lambent::frame
