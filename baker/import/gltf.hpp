// The room baker/import turns any glTF 2.0 file (.gltf or .glb) into a Scene: triangles with normals,
// materials, lights, animations and volumes. A path goes in, and a checked Scene with warnings comes out.
// Everything that the file claims is checked before use: a broken file gives one error that names the object
// in it (accessor 3, image "bark"), never a crash. The import works on the calling thread, and several may
// run at once.
#pragma once

#include <filesystem>

#include "baker/import/scene.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

struct ImportOptions {
  // Lets buffers and images lie outside the scene's folder: absolute paths, "..", links that lead out. This
  // is for scenes from a trusted place only, since a scene chooses which files are read.
  bool allow_outside = false;
};

// Errors: missing or unreadable file, not glTF 2.0, geometry in an unknown extension, broken accessors or
// buffers, or a scene without triangles and volumes.
Result<Scene> importScene(const std::filesystem::path& path, const ImportOptions& options = {});

}  // namespace lambent::baker
