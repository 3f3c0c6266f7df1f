#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "common/messages.h"

namespace strata {

/// All that must be equal between workers for their renders to be equal to the last bit (design,
/// section 4).
struct WorkerClass {
  std::string build;
  uint32_t kernel_revision = 0;
  std::map<std::string, std::string> libraries;
  std::string isa;
  Digest traced;
  bool operator==(const WorkerClass&) const = default;
};

WorkerClass ClassOf(const Hello& hello);

/// What differs, for people: "build 1a2b where the job has 3c4d"; empty when the two are equal.
std::string Difference(const WorkerClass& worker, const WorkerClass& job);

}  // namespace strata
