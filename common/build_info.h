#pragma once

#include <map>
#include <string>

namespace strata {

/// What two machines compare before they share a job. The revision is a digest over the sources
/// that make the binaries (proto, common, worker, coordinator), so that it says the same with and
/// without a git checkout, with and without uncommitted changes, and does not change with the docs.
/// Form: "0.1.0+" and 12 hexadecimal digits.
std::string BuildRevision();

/// "0.1.0".
std::string BuildVersion();

/// Name to version of what may decide bits or behaviour: compiler, glibc, and the packages found
/// when this was built (embree, openimageio, protobuf, grpc).
std::map<std::string, std::string> LibraryVersions();

}  // namespace strata
