#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "common/status.h"

namespace strata {

/// A SHA-256 digest (FIPS 180-4); names files, bundles and results.
struct Digest {
  std::array<uint8_t, 32> bytes{};

  /// 64 lower-case hexadecimal digits.
  std::string Hex() const;
  /// "sha256:" followed by Hex(), the form shown to people.
  std::string ToString() const;
  /// Accepts both forms; INVALID_ARGUMENT otherwise.
  static absl::StatusOr<Digest> Parse(std::string_view text);

  auto operator<=>(const Digest&) const = default;

  template <typename H>
  friend H AbslHashValue(H state, const Digest& digest) {
    return H::combine_contiguous(std::move(state), digest.bytes.data(), digest.bytes.size());
  }
};

/// Digests a stream of bytes. Integers and doubles enter as little-endian bytes.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;

  void Update(std::span<const std::byte> bytes);
  void Update(std::string_view text) { Update(std::as_bytes(std::span(text))); }
  /// The digest of all bytes so far; the object may not be used afterwards.
  Digest Finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

Digest DigestOf(std::string_view bytes);

/// Reads the file in blocks; NOT_FOUND or UNAVAILABLE with the path in the message.
absl::StatusOr<Digest> DigestOfFile(const std::filesystem::path& path);

}  // namespace strata
