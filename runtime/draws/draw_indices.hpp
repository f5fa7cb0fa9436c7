// Multi-draws whose shaders know which draw they are of: a vertex array whose one attribute, at location 0,
// steps once per instance through 0, 1, 2, ..., so that a command's base instance comes back. gl_DrawID is
// not in OpenGL 4.5.
#pragma once

#include <cstdint>

#include "runtime/gpu/objects.hpp"

namespace lambent::frame {

// As glMultiDrawElementsIndirect reads it.
struct DrawCommand {
  std::uint32_t count = 0, instance_count = 1, first_index = 0, base_vertex = 0, base_instance = 0;
};

class DrawIndices {
 public:
  explicit DrawIndices(std::string_view label) : vertices_(label) {}

  void reserve(std::size_t draw_count);
  // With `elements` as what indices are read from.
  void bind(const gpu::Buffer& elements) const {
    glBindVertexArray(vertices_.id());
    glVertexArrayElementBuffer(vertices_.id(), elements.id());
  }
  // Triangles of commands that follow each other in the bound indirect buffer.
  static void draw(std::uint32_t first_command, std::uint32_t command_count, gpu::Counters& counters);

 private:
  gpu::VertexArray vertices_;
  gpu::Buffer indices_;
};

}  // namespace lambent::frame
