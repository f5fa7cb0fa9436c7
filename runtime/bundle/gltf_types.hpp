// These types hold what Lambent keeps of a glTF file: nodes, materials, textures, cameras, lights and
// animations. The importer fills them from any glTF file, the bundle stores them, and the runtime draws from
// them. Units and axes are glTF's: metres, +Y up, right-handed, colours linear Rec.709. An index of -1 means
// "none".
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace lambent::gltf {

// Describes a transform by three parts, which animation channels replace one by one.
struct Trs {
  glm::vec3 translation{0.0f};
  glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};  // unit
  glm::vec3 scale{1.0f};
  bool operator==(const Trs&) const = default;
  glm::mat4 matrix() const;  // translation * rotation * scale
};

struct Node {
  std::string name;
  std::int32_t parent = -1;
  std::vector<std::int32_t> children;
  glm::mat4 parent_from_node{1.0f};
  std::int32_t mesh = -1;
  std::int32_t camera = -1;
  std::int32_t light = -1;  // index of a KHR_lights_punctual light, which shines along the node's -Z
  bool animated = false;    // true if some animation moves the node
  bool movable = false;     // extras.lambent.movable
  std::optional<Trs> trs;   // the parts of parent_from_node; animated nodes have them
};

// Describes a glTF 2.0 sampler, with the GL constants of the file.
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
  std::uint32_t texcoord = 0;  // n of TEXCOORD_n, 0 or 1
  // KHR_texture_transform, applied where the texture is looked up: uv' = offset + R(rotation) (scale * uv).
  glm::vec2 offset{0.0f}, scale{1.0f};
  float rotation_rad = 0.0f;
  bool operator==(const TextureRef&) const = default;

  glm::vec2 apply(glm::vec2 uv) const {
    const float c = std::cos(rotation_rad), s = std::sin(rotation_rad);
    const glm::vec2 scaled = scale * uv;
    return offset + glm::vec2(c * scaled.x + s * scaled.y, c * scaled.y - s * scaled.x);
  }
};

enum class AlphaMode : std::uint8_t { Opaque, Mask, Blend };

// A material is the metallic-roughness model of glTF 2.0 with KHR_materials_ior, _specular, _anisotropy,
// _transmission and _volume, or a measured BRDF. docs/conventions.md, "Materials", has the formulas.
struct Material {
  std::string name;
  glm::vec4 base_color{1.0f};     // linear
  TextureRef base_color_texture;  // sRGB colour, linear alpha; multiplies base_color
  float metallic = 1.0f, roughness = 1.0f;
  TextureRef metallic_roughness_texture;  // linear; G multiplies roughness, B multiplies metallic
  float ior = 1.5f;                       // KHR_materials_ior; at least 1, or 0 for infinite
  // KHR_materials_specular: strength (texture linear, in A) and colour (texture sRGB) of the dielectric
  // reflection.
  float specular = 1.0f;
  glm::vec3 specular_color{1.0f};
  TextureRef specular_texture, specular_color_texture;
  // KHR_materials_anisotropy: strength 0..1, and the angle of the longer lobe from the tangent towards the
  // bitangent. The texture is linear, with the direction from -1 to 1 in RG and the strength in B.
  float anisotropy = 0.0f, anisotropy_rotation_rad = 0.0f;
  TextureRef anisotropy_texture;
  // extras.lambent.brdf: index of a measured BRDF that replaces everything above except base_color's alpha.
  std::int32_t brdf = -1;
  // Emitted radiance: the factor times KHR_materials_emissive_strength. The texture multiplies it.
  glm::vec3 emissive{0.0f};
  TextureRef emissive_texture;  // sRGB colour
  TextureRef normal_texture;    // tangent space, linear
  float normal_scale = 1.0f;    // scale of the x and y of the texture's normal
  // KHR_materials_unlit: the surface shows its base colour as radiance in any light. It blocks light, but
  // reflects and emits none.
  bool unlit = false;
  AlphaMode alpha_mode = AlphaMode::Opaque;
  float alpha_cutoff = 0.5f;
  bool double_sided = false;
  // KHR_materials_transmission: the share of the light under the dielectric layer that passes through instead
  // of being reflected (texture linear, in R). Base colour tints it.
  float transmission = 0.0f;
  TextureRef transmission_texture;
  // KHR_materials_volume. A thickness of 0 means a thin wall, and a distance of 0 that nothing is absorbed.
  float thickness_m = 0.0f, attenuation_distance_m = 0.0f;
  glm::vec3 attenuation_color{1.0f};

  // Returns whether the surface is a pane, which light passes through. Blended surfaces let all of it pass.
  bool transmits() const {
    return transmission > 0.0f && metallic < 1.0f && !unlit && brdf < 0 && alpha_mode != AlphaMode::Blend;
  }
  // Returns the share of the light that meets a pane at a right angle and passes its face, before textures
  // and colour.
  float passedStraightOn() const {
    const float most = std::max({specular_color.r, specular_color.g, specular_color.b});
    return transmits()
               ? (1.0f - metallic) * transmission * (1.0f - specular * std::min(reflectance() * most, 1.0f))
               : 0.0f;
  }

  // Returns the dielectric reflectance at normal incidence from air, before specular strength and colour.
  float reflectance() const {
    const float ratio = ior > 0.0f ? (ior - 1.0f) / (ior + 1.0f) : 1.0f;
    return ratio * ratio;
  }
  // Returns whether the surface is purely diffuse: it is not metallic, and has either no specular strength or
  // roughness 1 everywhere, which is how glTF files say "diffuse". Lambent treats it everywhere as a Lambert
  // surface with albedo = base colour.
  bool isDiffuse() const {
    if (unlit) return true;
    if (brdf >= 0 || metallic > 0.0f) return false;
    return specular <= 0.0f || (roughness >= 1.0f && metallic_roughness_texture.texture < 0);
  }
};

// Holds the values of a material that can be changed while it is shown. Textures and vertex colours multiply
// them.
struct MaterialFactors {
  glm::vec3 base_color{1.0f};  // linear
  float alpha = 1.0f;
  float metallic = 1.0f, roughness = 1.0f;
  float ior = 1.5f;  // at least 1, or 0 for infinite
  float specular = 1.0f;
  glm::vec3 specular_color{1.0f};
  float anisotropy = 0.0f, anisotropy_rotation_rad = 0.0f;
  std::int32_t brdf = -1;    // measured table of the bundle that replaces all of the above; -1 if none
  glm::vec3 emission{0.0f};  // linear
  float emission_strength = 1.0f;
  float normal_scale = 1.0f;
  float alpha_cutoff = 0.5f;  // used by masked materials
};

struct Camera {
  std::string name;
  bool perspective = true;
  float yfov_rad = 0.8f;
  float aspect = 0.0f;             // width / height; 0 for that of the viewport
  float xmag = 1.0f, ymag = 1.0f;  // orthographic half sizes
  float znear = 0.01f;
  float zfar = 0.0f;  // 0 for infinite
};

// Describes a light of KHR_lights_punctual. On a surface that faces it, at distance d inside its cone, it
// gives an irradiance of colour x intensity / d², or colour x intensity if it is directional. It fades out
// towards `range_m` as the extension says.
struct Light {
  enum class Type : std::uint8_t { Directional, Point, Spot };
  std::string name;
  Type type = Type::Point;
  glm::vec3 color{1.0f};                                    // linear
  float intensity = 1.0f;                                   // candela (W/sr); lux (W/m²) if directional
  float range_m = 0.0f;                                     // 0 for no limit
  float inner_cone_rad = 0.0f, outer_cone_rad = 0.785398f;  // half angles of a spot, inner < outer <= pi/2
  bool operator==(const Light&) const = default;
};

// Holds the keyframes of one node's translation, rotation or scale. Values are stored as in glTF: 3 or 4
// numbers per key (quaternions as x, y, z, w). A cubic key has an in-tangent, a value and an out-tangent.
struct AnimationChannel {
  enum class Path : std::uint8_t { Translation, Rotation, Scale };
  enum class Interpolation : std::uint8_t { Step, Linear, Cubic };
  std::uint32_t node = 0;
  Path path = Path::Translation;
  Interpolation interpolation = Interpolation::Linear;
  std::vector<float> times_s;  // rising
  std::vector<float> values;
};

struct Animation {
  std::string name;
  std::vector<AnimationChannel> channels;
};

// Returns world_from_node for every node, composed in double. Parents may follow their children in the list.
std::vector<glm::mat4> worldTransforms(const std::vector<Node>& nodes);

// Evaluates animations at a point in time, as glTF 2.0, appendix C says: step, linear (slerp for rotations)
// or cubic Hermite splines. The first value holds before the first key, the last value after the last key.
// Quaternions are returned with unit length. Times that are not finite count as 0.

// Evaluate a Translation or Scale channel, and a Rotation channel.
glm::vec3 vectorAt(const AnimationChannel& channel, float time_s);
glm::quat rotationAt(const AnimationChannel& channel, float time_s);

// Returns the time of the last key in seconds, or 0 if there is none.
float durationOf(const Animation& animation);

// Sets the part of a node's transform that the channel animates.
void applyChannel(const AnimationChannel& channel, float time_s, Trs& parts);

// Sets trs and parent_from_node of all animated nodes for the time. If several channels animate the same
// part, the last one counts.
void applyAnimations(std::span<const Animation> animations, float time_s, std::vector<Node>& nodes);

}  // namespace lambent::gltf
