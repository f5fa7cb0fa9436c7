// Compiles tinygltf, because Debian's library is built with stb_image and its own file access, and this room
// wants neither (images stay encoded, files are resolved in scene_files.cpp). Warnings are off for this file
// alone.
#include <fstream>  // tinygltf's writer needs it even without its file access

#define TINYGLTF_IMPLEMENTATION
#include "baker/import/tinygltf.hpp"
