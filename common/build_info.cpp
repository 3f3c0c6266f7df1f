#include "common/build_info.h"

#include <gnu/libc-version.h>

#include "build_revision.h"

namespace strata {

std::string BuildRevision() { return STRATA_VERSION "+" STRATA_SOURCES; }

std::string BuildVersion() { return STRATA_VERSION; }

std::map<std::string, std::string> LibraryVersions() {
  return {{"compiler", "g++ " __VERSION__}, {"glibc", gnu_get_libc_version()},
          {"embree", STRATA_EMBREE},        {"openimageio", STRATA_OPENIMAGEIO},
          {"protobuf", STRATA_PROTOBUF},    {"grpc", STRATA_GRPC}};
}

}  // namespace strata
