// Declares the components of a scene's entities. Units are metres and radians unless a name says otherwise;
// axes are glTF's (+Y up, right-handed). Values that users may set are declared as fields; values that a
// system derives (WorldTransform, the current transform of a group) are not. Entities refer to each other by
// handles here, and by StableIds in files.
#pragma once

#include <compare>
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

#include "runtime/bundle/gltf_types.hpp"
#include "runtime/ecs/fields.hpp"
#include "runtime/ecs/registry.hpp"
#include "runtime/scene/bounds.hpp"

namespace lambent::scene {

// A StableId identifies an entity across sessions, in undo, world files and scripts. It is a 64-bit XXH3 hash
// of the bundle's id, the instance number and the names on the path from the root (with a count if siblings
// share a name). So a scene keeps its ids when it is imported again with nodes added or reordered elsewhere.
struct StableId {
  std::uint64_t value = 0;
  auto operator<=>(const StableId&) const = default;
};

enum class StableKind : std::uint8_t { Node = 1, Group, Draw, Lamp, Animation, Material };

// Returns the id of an instance's root entity.
StableId instanceId(std::string_view bundle_id, std::uint32_t instance);
// Returns the id of an entity below `parent`. `ordinal` is the number of earlier ones with the same parent,
// kind and name.
StableId childId(StableId parent, StableKind kind, std::string_view name, std::uint32_t ordinal);

struct Name {
  std::string value;

  static constexpr std::string_view kComponentName = "Name";
  static auto fields() { return std::tuple{ecs::Field{"name", &Name::value, ""}}; }
};

// Holds the local transform of a node: parent_from_node = translation * rotation * scale * shear. Any affine
// matrix can be written this way (transforms.hpp). Mirrors have a negative scale.
struct Transform {
  glm::vec3 translation{0.0f};
  glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
  glm::vec3 scale{1.0f};
  glm::vec3 shear{0.0f};  // shear of x by y, x by z, y by z; 0 for nodes with translation, rotation, scale
  ecs::Entity parent;     // if none or not alive, the parent is the world

  static constexpr std::string_view kComponentName = "Transform";
  static auto fields() {
    return std::tuple{ecs::Field{"translation", &Transform::translation, glm::vec3(0.0f), "m"},
                      ecs::Field{"rotation", &Transform::rotation, glm::quat(1.0f, 0.0f, 0.0f, 0.0f)},
                      ecs::Field{"scale", &Transform::scale, glm::vec3(1.0f)},
                      ecs::Field{"shear", &Transform::shear, glm::vec3(0.0f)}};
  }
};

// Holds the world matrix of an entity with a Transform. updateTransforms adds and updates it, and its version
// rises only if the matrix changes.
struct WorldTransform {
  glm::mat4 world_from_node{1.0f};
  std::uint64_t seen_local = 0, seen_parent = 0;  // versions from which the matrix was computed
  std::uint64_t visit = 0;                        // number of the last update that visited the entity
};

// Describes a rigid group of a bundle. Transfer and its samples are in the group's frame, which has the
// rotation and position of its root node, without scale. inverse(rotation) takes light into this frame.
struct RigidGroupComponent {
  std::uint32_t bundle = 0, group = 0;
  ecs::Entity node;  // the entity that it moves with: its root node, or the instance's root
  Box bounds;        // in the group's frame

  // world_from_group as baked.
  glm::quat rest_rotation{1.0f, 0.0f, 0.0f, 0.0f};
  glm::vec3 rest_translation{0.0f};
  glm::dmat4 node_from_world_at_rest{1.0};

  // Current world_from_group. updateTransforms updates it and gives the component a new version when it
  // changes.
  glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
  glm::vec3 translation{0.0f};
  // The whole motion since rest, including scale. It takes a world position as baked to the current one.
  glm::mat4 world_from_rest{1.0f};
  std::uint64_t seen_node = 0;  // version of the node's WorldTransform from which this was computed
};

// Describes one side of a primitive at a node, which is bundle::Draw as an entity.
struct DrawItem {
  std::uint32_t bundle = 0, draw = 0;
  std::uint32_t mesh = 0, primitive = 0;
  bool back = false;  // true if winding and normals are reversed
  std::int32_t material = -1;
  ecs::Entity node;   // entity whose WorldTransform places the mesh
  ecs::Entity group;  // entity of the rigid group whose light shades the draw
  Box bounds;         // in mesh space
};

// Describes the box of a volume, in voxel coordinates from 0 to `size`. It stands beside the
// RigidGroupComponent.
struct VolumeItem {
  glm::mat4 group_from_grid{1.0f};
  glm::uvec3 size{1};
};

// Describes a camera. It looks along the node's -Z and stands beside a Transform.
struct CameraComponent : gltf::Camera {
  std::uint32_t bundle = 0, camera = 0;

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

// Describes an emissive material of a rigid group (bundle::GroupLight), whose radiance is colour x strength.
// A change shows at once, with the shadows and bounces that were baked for it. Nodes with a KHR light have a
// LocalLightComponent instead.
struct LampComponent {
  std::uint32_t bundle = 0, group = 0, column = 0;
  glm::vec3 color{1.0f};  // linear; at first that of the bundle
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

// Describes a local light, which may move with the Transform beside it. It stands at the node's position and
// shines along the node's -Z if it has a direction. Point, spot and directional lights are those of
// KHR_lights_punctual; spheres and discs are surfaces of uniform radiance.
struct LocalLightComponent {
  enum class Kind : std::uint8_t { Point, Spot, Directional, Sphere, Disc };
  Kind kind = Kind::Point;
  glm::vec3 color{1.0f};  // linear
  float strength = 1.0f;  // candela for Point and Spot, lux for Directional, radiance for Sphere and Disc
  float radius_m = 0.0f;  // for Sphere and Disc
  float range_m = 0.0f;   // distance at which Point and Spot have faded out; 0 for no limit
  float inner_cone_rad = 0.0f, outer_cone_rad = 0.785398f;  // half angles of a Spot
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

// These are the names of the values of an enum in files and scripts, in their order.
inline constexpr std::string_view kLightKindWords[] = {"point", "spot", "directional", "sphere", "disc"};
constexpr std::span<const std::string_view> enumWords(LocalLightComponent::Kind) {
  return kLightKindWords;
}

// Describes an animation of a bundle, which is an entity of its own. scene::playAnimations moves the nodes of
// its channels.
struct AnimationComponent {
  std::uint32_t bundle = 0, animation = 0;
  float time_s = 0.0f;
  float speed = 1.0f;  // seconds of animation per second; negative plays backwards
  bool playing = true;
  bool loop = true;
  float posed_s = 0.0f;  // time of the current pose; playAnimations updates it

  static constexpr std::string_view kComponentName = "Animation";
  static auto fields() {
    using A = AnimationComponent;
    return std::tuple{ecs::Field{"time", &A::time_s, 0.0f, "s"},
                      ecs::Field{"speed", &A::speed, 1.0f, "", ecs::Range{-100.0f, 100.0f}},
                      ecs::Field{"playing", &A::playing, true}, ecs::Field{"loop", &A::loop, true}};
  }
};

// Holds the intensity and rotation of the light at infinity. There may be two sets of lights, between which
// it fades.
struct EnvironmentComponent {
  float intensity = 1.0f;     // factor of the radiance
  float rotation_deg = 0.0f;  // about +Y; positive rotations take +Z to +X
  float fade = 0.0f;          // 0 for the first set of lights, 1 for the second

  static constexpr std::string_view kComponentName = "Environment";
  static auto fields() {
    using E = EnvironmentComponent;
    return std::tuple{ecs::Field{"intensity", &E::intensity, 1.0f, "", ecs::Range{0.0f, 1e6f}},
                      ecs::Field{"rotation", &E::rotation_deg, 0.0f, "deg", ecs::Range{-360.0f, 360.0f}},
                      ecs::Field{"fade", &E::fade, 0.0f, "", ecs::Range{0.0f, 1.0f}}};
  }
};

}  // namespace lambent::scene
