// Import of .gltf and .glb by tinygltf. Everything that the file claims is checked before use: a broken file
// gives one error that names the object in it (accessor 3, image "bark"), never a crash.
#pragma once

#include <filesystem>

#include "baker/import/import_options.hpp"
#include "baker/import/scene.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

// Errors: missing or unreadable file, not glTF 2.0, unknown required extension, broken accessors or buffers,
// a scene without triangles.
Result<Scene> importScene(const std::filesystem::path& path, const ImportOptions& options = {});

}  // namespace lambent::baker
