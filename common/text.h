#pragma once

#include <absl/strings/str_cat.h>
#include <absl/strings/string_view.h>

#include <string>
#include <string_view>
#include <type_traits>

// Debian's Abseil has a string_view of its own, which does not convert from the standard one.

namespace strata {

inline absl::string_view ToAbsl(std::string_view text) { return {text.data(), text.size()}; }
inline std::string_view FromAbsl(absl::string_view text) { return {text.data(), text.size()}; }

namespace text_detail {
template <typename T>
decltype(auto) Piece(const T& part) {
  if constexpr (std::is_convertible_v<const T&, std::string_view>) {
    return ToAbsl(part);
  } else {
    return (part);
  }
}
}  // namespace text_detail

/// absl::StrCat that takes standard string views as well.
template <typename... Parts>
std::string StrCat(const Parts&... parts) {
  return absl::StrCat(text_detail::Piece(parts)...);
}

}  // namespace strata
