#include "runtime/draws/draw_indices.hpp"

#include <numeric>
#include <vector>

namespace lambent::frame {

void DrawIndices::reserve(std::size_t draw_count) {
  if (indices_.byteCount() >= 4 * draw_count) return;
  std::vector<std::uint32_t> indices(2 * draw_count);
  std::iota(indices.begin(), indices.end(), 0u);
  indices_ = gpu::Buffer("draw indices", 4 * indices.size());
  indices_.write(0, std::span<const std::uint32_t>(indices));
  constexpr GLuint kAttribute = 0;
  const GLuint array = vertices_.id();
  glVertexArrayVertexBuffer(array, 0, indices_.id(), 0, 4);
  glVertexArrayBindingDivisor(array, 0, 1);
  glVertexArrayAttribIFormat(array, kAttribute, 1, GL_UNSIGNED_INT, 0);
  glVertexArrayAttribBinding(array, kAttribute, 0);
  glEnableVertexArrayAttrib(array, kAttribute);
}

void DrawIndices::draw(std::uint32_t first_command, std::uint32_t command_count, gpu::Counters& counters) {
  glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT,
                              reinterpret_cast<const void*>(std::size_t{first_command} * sizeof(DrawCommand)),
                              static_cast<GLsizei>(command_count), 0);
  counters.draws += command_count;
  ++counters.draw_calls;
}

}  // namespace lambent::frame
