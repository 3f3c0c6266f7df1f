#include <fstream>  // tinygltf writes files too, and with TINYGLTF_NO_FS does not include this

#define TINYGLTF_IMPLEMENTATION
#include "worker/gltf/tinygltf.h"
