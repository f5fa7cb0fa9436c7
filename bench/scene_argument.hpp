// Takes `--scene=FILE` out of the arguments of a benchmark before Google Benchmark sees them. The default is
// the shipped gallery.
#pragma once

#include <algorithm>
#include <cstring>
#include <string>

inline std::string takeSceneArgument(int& argc, char** argv) {
  std::string file = LAMBENT_BINARY_DIR "/assets/gallery.glb";
  for (int i = 1; i < argc; ++i)
    if (std::strncmp(argv[i], "--scene=", 8) == 0) {
      file = argv[i] + 8;
      std::rotate(argv + i, argv + i + 1, argv + argc);
      --argc;
    }
  return file;
}
