#pragma once

#include <string>
#include <string_view>

#include "common/status.h"

namespace strata {

/// HOST:PORT taken apart; an IPv6 host without its brackets.
struct NetAddress {
  std::string host;
  int port = 0;  ///< 0 to 65535.
};

/// INVALID_ARGUMENT with the text and what is expected.
absl::StatusOr<NetAddress> ParseNetAddress(std::string_view text);

/// Whether the host means this machine alone: localhost, 127.0.0.0/8, ::1.
bool IsLoopback(std::string_view host);

}  // namespace strata
