// tinygltf as this room builds it; every user must see the same switches. For this room only: no header that
// others include may include it.
#pragma once

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#define TINYGLTF_USE_CPP14
// Debian's libdraco.so carries, and exports, a tinygltf of its own with other switches. Under its own name
// the linker would take whichever it meets first; under this one there is only ours.
#define tinygltf lambent_tinygltf
#include <tiny_gltf.h>
