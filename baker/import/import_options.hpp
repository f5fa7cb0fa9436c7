// These are the options of importScene().
#pragma once

namespace lambent::baker {

struct ImportOptions {
  // Lets buffers and images lie outside the scene's folder: absolute paths, "..", links that lead out. This
  // is for scenes from a trusted place only, since a scene chooses which files are read.
  bool allow_outside = false;
  // Refuses images that cannot be read, which else are left out with a warning. This is for files that may
  // still be written to.
  bool whole_images = false;
};

}  // namespace lambent::baker
