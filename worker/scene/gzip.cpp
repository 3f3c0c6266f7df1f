#include "worker/scene/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <limits>

#include "common/text.h"

namespace strata {

bool IsGzip(std::string_view bytes) { return bytes.substr(0, 3) == "\x1f\x8b\x08"; }

absl::StatusOr<std::string> Gunzip(std::string_view bytes, uint64_t limit) {
  constexpr int kGzipOfAnyWindow = 15 + 16;
  constexpr size_t kStep = size_t{1} << 20;
  const absl::Status damaged =
      absl::InvalidArgumentError("the gzip file is damaged or cut short; compress it again");
  z_stream stream = {};
  if (inflateInit2(&stream, kGzipOfAnyWindow) != Z_OK)
    return absl::ResourceExhaustedError("there is no memory to uncompress the file");
  struct End {
    z_stream* stream;
    ~End() { inflateEnd(stream); }
  } end{&stream};

  std::string text;
  size_t given = 0, written = 0;
  while (true) {
    if (stream.avail_in == 0) {
      const size_t part = std::min<size_t>(bytes.size() - given, std::numeric_limits<uInt>::max());
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + given));
      stream.avail_in = static_cast<uInt>(part);
      given += part;
    }
    if (written == text.size()) text.resize(text.size() + std::max(kStep, text.size() / 2));
    const size_t room = std::min<size_t>(text.size() - written, std::numeric_limits<uInt>::max());
    stream.next_out = reinterpret_cast<Bytef*>(text.data() + written);
    stream.avail_out = static_cast<uInt>(room);
    const int result = inflate(&stream, Z_NO_FLUSH);
    written += room - stream.avail_out;
    if (written > limit)
      return absl::InvalidArgumentError(
          StrCat("uncompressed the file has more than the ", limit, " bytes that are read"));
    const bool all_given = stream.avail_in == 0 && given == bytes.size();
    if (result == Z_STREAM_END) {
      if (all_given) break;
      if (inflateReset(&stream) != Z_OK) return damaged;
    } else if (result != Z_OK || (all_given && stream.avail_out > 0)) {
      return damaged;
    }
  }
  text.resize(written);
  return text;
}

}  // namespace strata
