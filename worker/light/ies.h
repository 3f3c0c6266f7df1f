#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/status.h"
#include "worker/math/vec.h"

namespace strata {

/// By its name.
bool IsIesFile(const std::string& path);

/// A luminaire's luminous intensity as an IES file gives it (ANSI/IESNA LM-63: 1986, 1991, 1995 and
/// 2002), its symmetry written out.
struct IesProfile {
  /// Type C photometry. Candelas are multiplied by the file's multiplier and ballast factors; what
  /// a file says of a tilted lamp (TILT=INCLUDE) is passed over, since it hangs as it was measured.
  /// INVALID_ARGUMENT as "NAME:LINE: what is wrong, what to do".
  static absl::StatusOr<IesProfile> Parse(std::string_view text, const std::string& name);

  /// Candelas towards a unit direction; z is up, and horizontal angles turn from x to y. Linear in
  /// both angles; 0 beyond the file's vertical angles.
  float Candelas(Vec3f direction) const;

  std::vector<float> vertical;    ///< Degrees from straight down, increasing.
  std::vector<float> horizontal;  ///< Degrees, increasing from 0 to 360; or 0 alone: all alike.
  std::vector<float> candelas;    ///< All vertical angles of the first horizontal one, and so on.
};

}  // namespace strata
