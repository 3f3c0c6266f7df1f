#pragma once

// tinygltf, which reads the JSON and the buffers. Images stay bytes, for common/image_file.h; files
// come from a FileSource. library.cpp compiles it.

#define TINYGLTF_USE_CPP14
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#include <tiny_gltf.h>
