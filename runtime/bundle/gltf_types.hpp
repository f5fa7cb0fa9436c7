// The part of a glTF file that Lambent keeps: nodes, materials, textures, cameras. Both sides share these
// types: the importer fills them from any glTF file, the bundle carries them through, the runtime draws from
// them. Units and axes are glTF's: metres, +Y up, right-handed, colours linear Rec.709. Indices are -1 where
// there is none.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace lambent::gltf {

struct Node {
  std::string name;
  std::int32_t parent = -1;
  std::vector<std::int32_t> children;
  glm::mat4 parent_from_node{1.0f};
  std::int32_t mesh = -1;
  std::int32_t camera = -1;
  bool animated = false;  // some animation moves it
  bool movable = false;   // extras.lambent.movable
};

// glTF 2.0 sampler enums as they stand in the file (GL constants).
struct Sampler {
  std::uint32_t wrap_s = 10497, wrap_t = 10497;        // REPEAT
  std::uint32_t mag_filter = 9729, min_filter = 9987;  // LINEAR, LINEAR_MIPMAP_LINEAR
  bool operator==(const Sampler&) const = default;
};

struct Texture {
  std::int32_t image = -1;
  Sampler sampler;
};

struct TextureRef {
  std::int32_t texture = -1;
  std::uint32_t texcoord = 0;  // which TEXCOORD_n
};

enum class AlphaMode : std::uint8_t { Opaque, Mask, Blend };

// Every material is Lambert with albedo = base colour until the glossy effect lands (docs/conventions.md).
struct Material {
  std::string name;
  glm::vec4 base_color{1.0f};     // linear
  TextureRef base_color_texture;  // sRGB colour, linear alpha; multiplies base_color
  float metallic = 1.0f, roughness = 1.0f;
  glm::vec3 emissive{0.0f};
  AlphaMode alpha_mode = AlphaMode::Opaque;
  float alpha_cutoff = 0.5f;
  bool double_sided = false;
};

struct Camera {
  std::string name;
  bool perspective = true;
  float yfov_rad = 0.8f;
  float aspect = 0.0f;             // 0: the viewport's
  float xmag = 1.0f, ymag = 1.0f;  // orthographic half sizes
  float znear = 0.01f;
  float zfar = 0.0f;  // 0: infinite
};

// world_from_node for every node; parents may stand after their children in the list.
std::vector<glm::mat4> worldTransforms(const std::vector<Node>& nodes);

}  // namespace lambent::gltf
