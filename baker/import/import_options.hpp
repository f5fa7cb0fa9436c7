// What importScene() may do beyond the usual.
#pragma once

namespace lambent::baker {

struct ImportOptions {
  // Buffers and images may lie outside the scene's folder: absolute paths, "..", links that lead out. For
  // scenes that come from a trusted place only, since a scene chooses which files are read.
  bool allow_outside = false;
};

}  // namespace lambent::baker
