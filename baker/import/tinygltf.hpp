// Configures tinygltf for this room; every user must see the same switches. It is for sources of this room
// only: no header that others include may include it.
#pragma once

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#define TINYGLTF_USE_CPP14
// Debian's libdraco.so contains and exports a tinygltf with other switches. If both had the same name, the
// linker would take either of them; the new name avoids that.
#define tinygltf lambent_tinygltf
#include <tiny_gltf.h>
