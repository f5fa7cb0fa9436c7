// What the entities of a scene carry. Units are metres and radians unless a name says otherwise; axes are
// glTF's (+Y up, right-handed). What a person may set is declared as fields; what a system derives
// (WorldTransform, the present place of a group) is not. Links between entities are handles here and
// StableIds in files.
#pragma once

#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/bundle/material_fields.hpp"
#include "runtime/ecs/entity.hpp"
#include "runtime/ecs/fields.hpp"
#include "runtime/scene/bounds.hpp"

namespace lambent::scene {

struct Name {
  std::string value;

  static constexpr std::string_view kComponentName = "Name";
  static auto fields() { return std::tuple{ecs::Field{"name", &Name::value, ""}}; }
};

// Where a node stands in its parent: parent_from_node = translation * rotation * scale * shear, which any
// affine matrix can be written as (affine.hpp). Mirrors have a negative scale.
struct Transform {
  glm::vec3 translation{0.0f};
  glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
  glm::vec3 scale{1.0f};
  glm::vec3 shear{0.0f};  // of x by y, x by z, y by z; 0 in files that keep to translation, rotation, scale
  ecs::Entity parent;     // none or no longer alive: the world. Set by setParent (transforms.hpp)

  static constexpr std::string_view kComponentName = "Transform";
  static auto fields() {
    return std::tuple{ecs::Field{"translation", &Transform::translation, glm::vec3(0.0f), "m"},
                      ecs::Field{"rotation", &Transform::rotation, glm::quat(1.0f, 0.0f, 0.0f, 0.0f)},
                      ecs::Field{"scale", &Transform::scale, glm::vec3(1.0f)},
                      ecs::Field{"shear", &Transform::shear, glm::vec3(0.0f)}};
  }
};

// Made and kept by updateTransforms for every entity with a Transform; its version rises when the matrix
// changes.
struct WorldTransform {
  glm::mat4 world_from_node{1.0f};
  std::uint64_t seen_local = 0, seen_parent = 0;  // versions that the matrix was computed from
  std::uint64_t visit = 0;                        // the last update that came by
};

// A rigid group of a bundle: transfer and its samples stand in the group's frame, which is the rotation and
// place of its root node, without scale. Light goes into it by inverse(rotation).
struct RigidGroupComponent {
  std::uint32_t bundle = 0, group = 0;
  ecs::Entity node;  // what it moves with: its root node, or the instance's root
  Box bounds;        // group frame

  // world_from_group when baked.
  glm::quat rest_rotation{1.0f, 0.0f, 0.0f, 0.0f};
  glm::vec3 rest_translation{0.0f};
  glm::dmat4 node_from_world_at_rest{1.0};

  // world_from_group now; kept by updateTransforms, which gives the component a new version when it changes.
  glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
  glm::vec3 translation{0.0f};
  // What the directions of the bake have been turned by: rotation * inverse(rest_rotation), the identity at
  // rest.
  glm::quat turn_since_rest{1.0f, 0.0f, 0.0f, 0.0f};
  // The whole motion since rest, with scale if there is any: takes a place in the world as baked to where it
  // is now.
  glm::mat4 world_from_rest{1.0f};
  std::uint64_t seen_node = 0;  // version of the node's WorldTransform that this was computed from
};

// One side of one primitive at one node: bundle::Draw as an entity.
struct DrawItem {
  std::uint32_t bundle = 0, draw = 0;
  std::uint32_t mesh = 0, primitive = 0;
  bool back = false;  // drawn with its winding and normals turned round
  std::int32_t material = -1;
  ecs::Entity node;   // its WorldTransform places the mesh
  ecs::Entity group;  // its RigidGroupComponent says whose light shades it
  Box bounds;         // mesh space
};

// Beside the RigidGroupComponent of a volume: the box that it fills, in voxel coordinates from 0 to size.
struct VolumeItem {
  glm::mat4 group_from_grid{1.0f};
  glm::uvec3 size{1};
};

// Beside the Transform of a node that carries a camera; looks along the node's -Z. As gltf::Camera.
struct CameraComponent {
  std::uint32_t bundle = 0, camera = 0;
  bool perspective = true;
  float yfov_rad = 0.8f;
  float aspect = 0.0f;             // 0: the viewport's
  float xmag = 1.0f, ymag = 1.0f;  // orthographic half sizes
  float znear = 0.01f;
  float zfar = 0.0f;  // 0: infinite

  static constexpr std::string_view kComponentName = "Camera";
  static auto fields() {
    using C = CameraComponent;
    constexpr float kFar = 1e9f;
    return std::tuple{
        ecs::Field{"perspective", &C::perspective, true},
        ecs::Field{"yfov", &C::yfov_rad, 0.8f, "rad", ecs::Range{0.001f, 0.999f * std::numbers::pi_v<float>}},
        ecs::Field{"aspect", &C::aspect, 0.0f, "", ecs::Range{0.0f, 100.0f}},
        ecs::Field{"xmag", &C::xmag, 1.0f, "m"},
        ecs::Field{"ymag", &C::ymag, 1.0f, "m"},
        ecs::Field{"znear", &C::znear, 0.01f, "m", ecs::Range{0.0f, kFar}},
        ecs::Field{"zfar", &C::zfar, 0.0f, "m", ecs::Range{0.0f, kFar}}};
  }
};

// An emissive material of a rigid group, as bundle::GroupLight: it gives colour x strength as radiance. Lit
// anew at once, with the shadows and bounces that were baked for it. Lamps have a LocalLightComponent
// instead.
struct LampComponent {
  std::uint32_t bundle = 0, group = 0, column = 0;
  glm::vec3 color{1.0f};  // linear; the bundle's at first
  float strength = 1.0f;
  bool enabled = true;

  glm::vec3 radiance() const { return enabled ? strength * color : glm::vec3(0.0f); }

  static constexpr std::string_view kComponentName = "Lamp";
  static auto fields() {
    using L = LampComponent;
    return std::tuple{ecs::Field{"color", &L::color, glm::vec3(1.0f)},
                      ecs::Field{"strength", &L::strength, 1.0f, "", ecs::Range{0.0f, 1e6f}},
                      ecs::Field{"enabled", &L::enabled, true}};
  }
};

// A material of a bundle, an entity of its own: the factors that surfaces are shaded by, before textures and
// vertex colours. What is changed shows in the next frame as far as it is no part of what was baked
// (frame/material_rebake.hpp says what is). What a LampComponent says is given off goes before `emission`.
struct MaterialComponent : gltf::MaterialFactors {
  std::uint32_t bundle = 0, material = 0;

  static constexpr std::string_view kComponentName = "Material";
  // The values that the table of a material's fields says can be changed, in its order.
  static auto fields() {
    return std::apply(
        [](const auto&... row) {
          return std::tuple_cat(
              std::apply([](const auto&... live) { return std::tuple{fieldOf(live)...}; }, row.live)...);
        },
        gltf::kMaterialFields);
  }

 private:
  template <class T>
  static ecs::Field<MaterialComponent, T> fieldOf(const gltf::LiveValue<T>& live) {
    std::optional<ecs::Range<T>> range;
    if (live.range) range = {live.range->least, live.range->greatest};
    return {live.name, live.factor, gltf::MaterialFactors().*live.factor, live.unit, range};
  }
};

// A light that stands in the scene and may move, beside a Transform: at the node's place, shining along its
// -Z where it has a direction. Punctual kinds are those of KHR_lights_punctual; spheres and discs are
// surfaces of uniform radiance.
struct LocalLightComponent {
  enum class Kind : std::uint8_t { Point, Spot, Directional, Sphere, Disc };
  Kind kind = Kind::Point;
  glm::vec3 color{1.0f};  // linear
  float strength = 1.0f;  // Point, Spot: candela; Directional: lux; Sphere, Disc: radiance
  float radius_m = 0.0f;  // Sphere, Disc
  float range_m = 0.0f;   // Point, Spot: where it fades out, 0: never
  float inner_cone_rad = 0.0f, outer_cone_rad = 0.785398f;  // Spot
  bool enabled = true;

  glm::vec3 power() const { return enabled ? strength * color : glm::vec3(0.0f); }

  static constexpr std::string_view kComponentName = "Light";
  static auto fields() {
    using L = LocalLightComponent;
    constexpr float kHalfPi = 0.5f * std::numbers::pi_v<float>;
    return std::tuple{
        ecs::Field{"kind", &L::kind, Kind::Point},
        ecs::Field{"color", &L::color, glm::vec3(1.0f)},
        ecs::Field{"strength", &L::strength, 1.0f, "", ecs::Range{0.0f, 1e9f}},
        ecs::Field{"radius", &L::radius_m, 0.0f, "m", ecs::Range{0.0f, 1e6f}},
        ecs::Field{"range", &L::range_m, 0.0f, "m", ecs::Range{0.0f, 1e9f}},
        ecs::Field{"inner_cone", &L::inner_cone_rad, 0.0f, "rad", ecs::Range{0.0f, kHalfPi}},
        ecs::Field{"outer_cone", &L::outer_cone_rad, 0.785398f, "rad", ecs::Range{0.0f, kHalfPi}},
        ecs::Field{"enabled", &L::enabled, true}};
  }
};

// The words for the values of an enum, in their order: what files and scripts call them.
inline constexpr std::string_view kLightKindWords[] = {"point", "spot", "directional", "sphere", "disc"};
constexpr std::span<const std::string_view> enumWords(LocalLightComponent::Kind) {
  return kLightKindWords;
}

// One animation of a bundle, an entity of its own; scene::playAnimations moves what its channels name.
struct AnimationComponent {
  std::uint32_t bundle = 0, animation = 0;
  float time_s = 0.0f;
  float speed = 1.0f;  // seconds of animation per second; negative plays backwards
  bool playing = true;
  bool loop = true;
  float posed_s = 0.0f;  // the time that the nodes stand at; kept by playAnimations

  static constexpr std::string_view kComponentName = "Animation";
  static auto fields() {
    using A = AnimationComponent;
    return std::tuple{ecs::Field{"time", &A::time_s, 0.0f, "s"},
                      ecs::Field{"speed", &A::speed, 1.0f, "", ecs::Range{-100.0f, 100.0f}},
                      ecs::Field{"playing", &A::playing, true}, ecs::Field{"loop", &A::loop, true}};
  }
};

// How the light from outside, sky and probes, stands over the scene. There may be two sets of it to fade
// between.
struct EnvironmentComponent {
  float intensity = 1.0f;     // factor on its radiance
  float rotation_deg = 0.0f;  // about +Y; positive turns take +Z to +X
  float fade = 0.0f;          // 0: the first set of lights, 1: the second

  static constexpr std::string_view kComponentName = "Environment";
  static auto fields() {
    using E = EnvironmentComponent;
    return std::tuple{ecs::Field{"intensity", &E::intensity, 1.0f, "", ecs::Range{0.0f, 1e6f}},
                      ecs::Field{"rotation", &E::rotation_deg, 0.0f, "deg", ecs::Range{-360.0f, 360.0f}},
                      ecs::Field{"fade", &E::fade, 0.0f, "", ecs::Range{0.0f, 1.0f}}};
  }
};

}  // namespace lambent::scene
