// Declares the triangle mesh of the scene generator: in metres, +Y up, counter-clockwise seen from outside.
// Only the generator uses it; the programs read the glTF files that it writes.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace lambent::assets {

struct Mesh {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;    // unit length
  std::vector<glm::vec2> texcoords;  // empty or one per vertex
  std::vector<std::uint32_t> indices;
};

// Appends `more`, transformed by a matrix without shear. Both must have texture coordinates, or neither.
void append(Mesh& mesh, const Mesh& more, const glm::mat4& place = glm::mat4(1.0f));

}  // namespace lambent::assets
