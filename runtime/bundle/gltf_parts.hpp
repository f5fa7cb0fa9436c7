// Writes and reads the parts of the glTF document that have files of their own: materials, cameras and
// lights, and animations. Only this room includes this header; gltf_json.cpp puts the parts together. Readers
// throw JsonFault.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>

#include "runtime/bundle/container.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/bundle/json_fields.hpp"

namespace lambent::bundle {

inline constexpr const char* kTextureTransform = "KHR_texture_transform";
inline constexpr const char* kEmissiveStrength = "KHR_materials_emissive_strength";
inline constexpr const char* kPunctualLights = "KHR_lights_punctual";

// Adds the extensions that the material needs to `used`.
Json materialJson(const gltf::Material& material, std::set<std::string>& used);
gltf::Material readMaterial(const Field& field, std::size_t texture_count);

Json cameraJson(const gltf::Camera& camera);
gltf::Camera readCamera(const Field& field);
Json lightJson(const gltf::Light& light);
gltf::Light readLight(const Field& field);

// Returns the keyframes of an animation, which form one view: for each channel its times, then its values,
// all float32. The views of the animations are the last of Description::views, in order.
Blob animationBytes(const gltf::Animation& animation);
Json animationJson(const gltf::Animation& animation, std::size_t view, Json& accessors);
// Gives times and values their sizes, which must fill the view; loadAnimation() fills in the numbers.
gltf::Animation readAnimation(const Field& field, const std::vector<Field>& accessors, std::size_t view,
                              std::uint64_t view_bytes, const std::vector<gltf::Node>& nodes);
// Fills in the keyframes from the bytes of the view, whose length must match the sizes. Returns false if
// times do not rise or a number is not finite.
bool loadAnimation(gltf::Animation& animation, std::span<const std::byte> bytes);

// Reads a field that refers to a payload of the bundle.

// Returns the index of a payload. Throws JsonFault if its type or, if given, its length is another.
inline std::uint32_t payloadIndex(const Field& field, const Description& d, PayloadType type,
                                  std::optional<std::uint64_t> raw_length) {
  const std::uint32_t index = field.index(d.payloads.size());
  if (d.payloads[index].type != type) field.fault("is a payload of another type");
  if (raw_length && d.payloads[index].raw_length != *raw_length) field.fault("is a payload of another size");
  return index;
}

// Writes and reads the JSON of a group's volume and neighborhood grids.
Json volumeJson(const VolumeGrid& volume);
Json neighborhoodJson(const NeighborhoodGrid& grid);

// Reads the grids of a group whose cells have been read. Throws JsonFault if grids and cells do not agree.
void readGrids(const Field& field, const Description& d, Group& group);

}  // namespace lambent::bundle
