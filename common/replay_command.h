#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/job.h"

// Commands that show a failure again, to be pasted into a shell in the folder that the job's scene
// was taken from: the scene's own, or what --root said.

namespace strata {

/// "strata replay ..." for one sample, with every option that decides its bits, whatever the scene
/// file says. The crop is none of them.
std::string ReplayCommand(const JobSpec& spec, int x, int y, uint32_t replicate, uint32_t sample);

/// "strata check ..." for a scene that does not load.
std::string CheckCommand(const JobSpec& spec);

/// `word` as a POSIX shell reads it back, in quotes where it needs any.
std::string ShellQuoted(std::string_view word);

}  // namespace strata
