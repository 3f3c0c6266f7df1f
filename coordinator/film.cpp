#include "coordinator/film.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <system_error>
#include <thread>

#include "coordinator/pixel_merge.h"

namespace strata {
namespace {

// docs/film-format.md tells what these are. All integers are little-endian.
static_assert(std::endian::native == std::endian::little);
constexpr char kMagic[8] = {'S', 'T', 'R', 'A', 'T', 'A', 'F', 'M'};
constexpr uint32_t kVersion = 1;
constexpr size_t kPageBytes = 4096;
constexpr size_t kTileHeaderBytes = 64;

struct FileHeader {
  char magic[8];
  uint32_t version, layer;
  int32_t x0, y0, x1, y1, tile, estimated, plain, replicates;
  uint64_t file_bytes;
  std::array<uint8_t, 32> checksum;  ///< SHA-256 of all before it.
};
static_assert(sizeof(FileHeader) == 88 && sizeof(PixelCounts) == 16);

Digest ChecksumOf(const FileHeader& header) {
  return DigestOf({reinterpret_cast<const char*>(&header), offsetof(FileHeader, checksum)});
}

size_t PixelBytes(const PixelLayout& layout) {
  return sizeof(PixelCounts) + static_cast<size_t>(layout.Doubles()) * sizeof(double);
}

size_t TileBytes(const FilmGeometry& geometry) {
  const size_t edge = static_cast<size_t>(geometry.grid.tile);
  const size_t bytes = kTileHeaderBytes + edge * edge * PixelBytes(geometry.layout);
  return (bytes + kPageBytes - 1) / kPageBytes * kPageBytes;
}

size_t FileBytes(const FilmGeometry& geometry) {
  return kPageBytes + geometry.grid.Count() * TileBytes(geometry);
}

FileHeader HeaderOf(const FilmGeometry& geometry) {
  const PixelRect& crop = geometry.grid.crop;
  FileHeader header{};
  std::memcpy(header.magic, kMagic, sizeof(kMagic));
  header.version = kVersion;
  header.layer = static_cast<uint32_t>(geometry.layer);
  header.x0 = crop.x0, header.y0 = crop.y0, header.x1 = crop.x1, header.y1 = crop.y1;
  header.tile = geometry.grid.tile;
  header.estimated = geometry.layout.estimated;
  header.plain = geometry.layout.plain;
  header.replicates = kReplicates;
  header.file_bytes = FileBytes(geometry);
  header.checksum = ChecksumOf(header).bytes;
  return header;
}

absl::StatusOr<FilmGeometry> ReadHeader(const FileHeader& header, size_t file_bytes) {
  if (std::memcmp(header.magic, kMagic, sizeof(kMagic)) != 0) {
    return absl::DataLossError("it is not a film");
  }
  if (header.version != kVersion) {
    return absl::DataLossError(
        fmt::format("version {} is not {}, the one known here", header.version, kVersion));
  }
  if (header.checksum != ChecksumOf(header).bytes) {
    return absl::DataLossError("the checksum of its header is wrong");
  }
  if (header.layer != static_cast<uint32_t>(FilmLayer::kPath) || header.replicates != kReplicates) {
    return absl::DataLossError("its layer or number of replicates is not known here");
  }
  FilmGeometry geometry;
  geometry.grid = {{header.x0, header.y0, header.x1, header.y1}, header.tile};
  geometry.layout = {header.estimated, header.plain};
  if (header.file_bytes != file_bytes) {
    return absl::DataLossError(
        fmt::format("it has {} bytes where its header says {}", file_bytes, header.file_bytes));
  }
  return geometry;
}

absl::Status SystemError(const std::filesystem::path& path, std::string_view what) {
  const int error = errno;
  std::string message = fmt::format("{}: {}: {}", path.string(), what, std::strerror(error));
  return error == ENOSPC ? absl::ResourceExhaustedError(message) : absl::UnavailableError(message);
}

/// Closes the descriptor at the end of a scope; a mapping outlives it.
struct Descriptor {
  int fd;
  ~Descriptor() {
    if (fd >= 0) close(fd);
  }
};

absl::StatusOr<std::byte*> Map(int fd, size_t bytes, const std::filesystem::path& path) {
  void* data = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  if (data == MAP_FAILED) return SystemError(path, "cannot be mapped");
  return static_cast<std::byte*>(data);
}

/// Reserves the file's space where the file system can; elsewhere the file stays sparse.
absl::Status Reserve(int fd, size_t bytes, const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(path.parent_path(), error);
  if (!error && space.available < bytes) {
    return absl::ResourceExhaustedError(
        fmt::format("{}: the film needs {} bytes and the disk has {} left; free some or render "
                    "less of the frame",
                    path.string(), bytes, space.available));
  }
  if (fallocate(fd, 0, 0, static_cast<off_t>(bytes)) == 0) return absl::OkStatus();
  if (errno != EOPNOTSUPP) return SystemError(path, fmt::format("no room for {} bytes", bytes));
  if (ftruncate(fd, static_cast<off_t>(bytes)) == 0) return absl::OkStatus();
  return SystemError(path, fmt::format("cannot have {} bytes", bytes));
}

}  // namespace

absl::StatusOr<std::unique_ptr<Film>> Film::Create(const std::filesystem::path& path,
                                                   const FilmGeometry& geometry) {
  const Descriptor file{open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)};
  if (file.fd < 0) return SystemError(path, "cannot be created");
  const FileHeader header = HeaderOf(geometry);
  if (const absl::Status status = Reserve(file.fd, header.file_bytes, path); !status.ok()) {
    unlink(path.c_str());
    return status;
  }
  STRATA_ASSIGN_OR_RETURN(std::byte * data, Map(file.fd, header.file_bytes, path));
  std::memcpy(data, &header, sizeof(header));
  return std::unique_ptr<Film>(new Film(data, header.file_bytes, geometry));
}

absl::StatusOr<std::unique_ptr<Film>> Film::Open(const std::filesystem::path& path) {
  const Descriptor file{open(path.c_str(), O_RDWR | O_CLOEXEC)};
  if (file.fd < 0) return SystemError(path, "cannot be opened");
  FileHeader header;
  struct stat info;
  if (fstat(file.fd, &info) != 0) return SystemError(path, "cannot be examined");
  if (pread(file.fd, &header, sizeof(header), 0) != static_cast<ssize_t>(sizeof(header))) {
    return absl::DataLossError(fmt::format("{}: it ends within its header", path.string()));
  }
  const size_t bytes = static_cast<size_t>(info.st_size);
  const absl::StatusOr<FilmGeometry> geometry = ReadHeader(header, bytes);
  if (!geometry.ok()) return Annotate(geometry.status(), path.string());
  STRATA_ASSIGN_OR_RETURN(std::byte * data, Map(file.fd, bytes, path));
  return std::unique_ptr<Film>(new Film(data, bytes, *geometry));
}

Film::Film(std::byte* data, size_t bytes, const FilmGeometry& geometry)
    : data_(data),
      bytes_(bytes),
      geometry_(geometry),
      pixel_bytes_(PixelBytes(geometry.layout)),
      tile_bytes_(TileBytes(geometry)) {}

Film::~Film() { munmap(data_, bytes_); }

std::byte* Film::TileRecord(uint32_t tile) const { return data_ + kPageBytes + tile * tile_bytes_; }

std::byte* Film::PixelRecord(uint32_t tile, int64_t pixel) const {
  return TileRecord(tile) + kTileHeaderBytes + static_cast<size_t>(pixel) * pixel_bytes_;
}

FilmPixel Film::At(int x, int y) const {
  const TileGrid& grid = geometry_.grid;
  const uint32_t tile = grid.IndexOf(x, y);
  const PixelRect rect = grid.Rect(tile);
  const std::byte* record =
      PixelRecord(tile, static_cast<int64_t>(y - rect.y0) * rect.Width() + (x - rect.x0));
  return {reinterpret_cast<const PixelCounts*>(record),
          reinterpret_cast<const double*>(record + sizeof(PixelCounts))};
}

MergeFront Film::Front(uint32_t tile) const {
  return *reinterpret_cast<const MergeFront*>(TileRecord(tile));
}

void Film::Merge(const Partial& partial, MergeFront next) {
  const PixelLayout& layout = geometry_.layout;
  const size_t doubles = static_cast<size_t>(layout.Doubles());
  for (size_t i = 0; i < partial.samples.size(); ++i) {
    if (partial.samples[i] == 0) continue;
    std::byte* record = PixelRecord(partial.unit.tile, static_cast<int64_t>(i));
    PixelCounts& counts = *reinterpret_cast<PixelCounts*>(record);
    MergePixel(layout, counts.samples, reinterpret_cast<double*>(record + sizeof(PixelCounts)),
               partial.samples[i], &partial.values[i * doubles]);
    counts.samples += partial.samples[i];
    counts.rays += partial.rays[i];
    counts.nonfinite += partial.nonfinite[i];
  }
  *reinterpret_cast<MergeFront*>(TileRecord(partial.unit.tile)) = next;
}

Digest Film::RowDigest(int y) const {
  const PixelRect& crop = geometry_.grid.crop;
  const size_t doubles = static_cast<size_t>(geometry_.layout.Doubles());
  const size_t entry_bytes = 2 * sizeof(uint32_t) + doubles * sizeof(double);
  std::vector<std::byte> row(static_cast<size_t>(crop.Width()) * entry_bytes);
  std::byte* entry = row.data();
  for (int x = crop.x0; x < crop.x1; ++x, entry += entry_bytes) {
    const FilmPixel pixel = At(x, y);
    std::memcpy(entry, &pixel.counts->samples, sizeof(uint32_t));
    std::memcpy(entry + sizeof(uint32_t), &pixel.counts->nonfinite, sizeof(uint32_t));
    std::memcpy(entry + 2 * sizeof(uint32_t), pixel.values, doubles * sizeof(double));
  }
  Sha256 sha;
  sha.Update(row);
  return sha.Finish();
}

Digest Film::ResultDigest() const {
  const PixelRect& crop = geometry_.grid.crop;
  std::vector<Digest> rows(static_cast<size_t>(crop.Height()));
  std::atomic<size_t> next{0};
  const auto work = [&] {
    for (size_t i = next++; i < rows.size(); i = next++) {
      rows[i] = RowDigest(crop.y0 + static_cast<int>(i));
    }
  };
  {
    const size_t threads = std::min<size_t>(std::thread::hardware_concurrency(), rows.size());
    std::vector<std::jthread> helpers;
    for (size_t t = 1; t < threads; ++t) helpers.emplace_back(work);
    work();
  }
  const int32_t frame[] = {
      crop.x0, crop.y0, crop.x1, crop.y1, geometry_.layout.estimated, geometry_.layout.plain};
  Sha256 sha;
  sha.Update("strata result 1\n");
  sha.Update(std::as_bytes(std::span(frame)));
  for (const Digest& row : rows) sha.Update(std::as_bytes(std::span(row.bytes)));
  return sha.Finish();
}

}  // namespace strata
