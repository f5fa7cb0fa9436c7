// The parts of the glTF document that stand in files of their own: materials, lenses (cameras and lights),
// animations. Inside this room only; gltf_json.cpp puts them together. Readers throw JsonFault.
#pragma once

#include <set>
#include <span>
#include <string>

#include "runtime/bundle/description.hpp"
#include "runtime/bundle/json_fields.hpp"
#include "runtime/bundle/writer.hpp"

namespace lambent::bundle {

inline constexpr const char* kTextureTransform = "KHR_texture_transform";
inline constexpr const char* kEmissiveStrength = "KHR_materials_emissive_strength";
inline constexpr const char* kPunctualLights = "KHR_lights_punctual";

// `used` collects the extensions that the JSON makes use of.
Json materialJson(const gltf::Material& material, std::set<std::string>& used);
gltf::Material readMaterial(const Field& field, std::size_t texture_count);

Json cameraJson(const gltf::Camera& camera);
gltf::Camera readCamera(const Field& field);
Json lightJson(const gltf::Light& light);
gltf::Light readLight(const Field& field);

// An animation's keyframes are one view: of every channel its times, then its values, all float32. The views
// of the animations are the last ones of Description::views, in order.
Blob animationBytes(const gltf::Animation& animation);
Json animationJson(const gltf::Animation& animation, std::size_t view, Json& accessors);
// Times and values get their sizes, checked against the view's; loadAnimation() fills them.
gltf::Animation readAnimation(const Field& field, const std::vector<Field>& accessors, std::size_t view,
                              std::uint64_t view_bytes, const std::vector<gltf::Node>& nodes);
// False where times do not rise or a number is not finite. `bytes` are as long as the sizes say.
bool loadAnimation(gltf::Animation& animation, std::span<const std::byte> bytes);

}  // namespace lambent::bundle
