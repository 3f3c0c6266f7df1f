#include "common/net_address.h"

#include <charconv>

namespace strata {

absl::StatusOr<NetAddress> ParseNetAddress(std::string_view text) {
  const auto malformed = [&] {
    return absl::InvalidArgumentError(
        absl::StrCat("\"", std::string(text),
                     "\" is no address; write HOST:PORT, such as 127.0.0.1:7447 or [::1]:7447"));
  };
  const size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) return malformed();
  std::string_view host = text.substr(0, colon);
  const std::string_view port = text.substr(colon + 1);
  if (host.starts_with('[') && host.ends_with(']')) {
    host = host.substr(1, host.size() - 2);
  } else if (host.find(':') != std::string_view::npos) {
    return malformed();
  }
  NetAddress address{std::string(host), 0};
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), address.port);
  if (host.empty() || error != std::errc() || end != port.data() + port.size() ||
      address.port < 0 || address.port > 65535) {
    return malformed();
  }
  return address;
}

bool IsLoopback(std::string_view host) {
  const auto is_digits_and_dots = [](std::string_view text) {
    return text.find_first_not_of("0123456789.") == std::string_view::npos;
  };
  return host == "localhost" || host == "::1" ||
         (host.starts_with("127.") && is_digits_and_dots(host));
}

}  // namespace strata
