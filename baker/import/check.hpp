// Checks a glTF document before anything reads it by index. tinygltf trusts much of what a file says (it
// follows bufferView numbers, offsets and Draco attributes unchecked, cuts 64-bit numbers to int, drops
// broken primitives without a word), so a document passes here first: types, ranges, references, byte extents
// of every view and accessor, the node tree. After this, code in this room may follow any index.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "runtime/base/result.hpp"

namespace lambent::baker {

// The extensions that this room reads. Others are refused where required and warned about where not.
inline constexpr std::array<std::string_view, 11> kExtensions{
    "KHR_draco_mesh_compression",      "KHR_mesh_quantization",
    "KHR_texture_transform",           "EXT_meshopt_compression",
    "EXT_mesh_gpu_instancing",         "KHR_lights_punctual",
    "KHR_materials_emissive_strength", "KHR_materials_unlit",
    "KHR_materials_specular",          "KHR_materials_ior",
    "KHR_materials_anisotropy"};

// Errors name `file` and the object, such as "accessor 3".
Result<void> checkDocument(const nlohmann::json& document, const std::string& file);

}  // namespace lambent::baker
