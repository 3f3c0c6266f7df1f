#pragma once

#include <nlohmann/json.hpp>

#include "common/job.h"

namespace strata {

/// Keeps the order in which its keys were given.
using Json = nlohmann::ordered_json;

/// x0, y0, x1, y1.
inline Json RectJson(const PixelRect& rect) {
  return Json::array({rect.x0, rect.y0, rect.x1, rect.y1});
}

}  // namespace strata
