// Makes multi-draws whose shaders know the index of their draw. The vertex array has one attribute, at
// location 0, that steps once per instance through 0, 1, 2, ..., so that a shader reads its command's base
// instance. gl_DrawID is not in OpenGL 4.5.
#pragma once

#include <cstdint>

#include "runtime/gpu/objects.hpp"

namespace lambent::frame {

// Describes a command in the layout of glMultiDrawElementsIndirect.
struct DrawCommand {
  std::uint32_t count = 0, instance_count = 1, first_index = 0, base_vertex = 0, base_instance = 0;
};

class DrawIndices {
 public:
  explicit DrawIndices(std::string_view label) : vertices_(label) {}

  void reserve(std::size_t draw_count);
  // Binds the vertex array with `elements` as its index buffer.
  void bind(const gpu::Buffer& elements) const {
    glBindVertexArray(vertices_.id());
    glVertexArrayElementBuffer(vertices_.id(), elements.id());
  }
  // Draws the triangles of consecutive commands in the bound indirect buffer.
  static void draw(std::uint32_t first_command, std::uint32_t command_count, gpu::Counters& counters);

 private:
  gpu::VertexArray vertices_;
  gpu::Buffer indices_;
};

}  // namespace lambent::frame
