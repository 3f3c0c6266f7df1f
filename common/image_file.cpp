#include "common/image_file.h"

#include <OpenImageIO/imageio.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <utility>

namespace strata {
namespace {

absl::Status BadImage(const std::filesystem::path& path, const std::string& why) {
  return absl::InvalidArgumentError(absl::StrCat(path.string(), ": ", why));
}

/// OpenImageIO's words, in one line.
std::string OneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text.empty() ? "unknown error" : text;
}

/// Sizes are claims of the file until its pixels are read, so memory is not given for any claim.
absl::Status CheckSize(const std::filesystem::path& path, const OIIO::ImageSpec& spec,
                       uint64_t bytes) {
  constexpr int kMaxEdge = 65536, kMaxChannels = 64;
  constexpr uint64_t kMaxValues = uint64_t{1} << 30;
  // More than any of the formats compresses a constant image.
  constexpr uint64_t kMaxCompression = 16384;
  const std::string size =
      absl::StrCat(spec.width, " x ", spec.height, " pixels with ", spec.nchannels, " channels");
  if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1 || spec.depth > 1)
    return BadImage(path, absl::StrCat("no flat image: ", size));
  const uint64_t values =
      static_cast<uint64_t>(spec.width) * spec.height * static_cast<uint64_t>(spec.nchannels);
  if (spec.width > kMaxEdge || spec.height > kMaxEdge || spec.nchannels > kMaxChannels ||
      values > kMaxValues)
    return BadImage(path, absl::StrCat("the image is too large: ", size));
  if (values / kMaxCompression > bytes)
    return BadImage(path, absl::StrCat("the file is too short for ", size));
  return absl::OkStatus();
}

struct OpenImage {
  std::unique_ptr<OIIO::ImageInput> input;
  OIIO::ImageSpec spec;
};

/// Opens `path` with the reader of `format`, or with that of its extension if it is empty. Errors
/// call it `name`.
absl::StatusOr<OpenImage> OpenAs(const std::filesystem::path& name,
                                 const std::filesystem::path& path, const std::string& format,
                                 uint64_t bytes) {
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);  // Colours as stored, not multiplied by alpha.
  OpenImage image;
  if (format.empty()) {
    image.input = OIIO::ImageInput::open(path.string(), &config);
  } else {
    image.input = OIIO::ImageInput::create(format);
    OIIO::ImageSpec spec;
    if (image.input && !image.input->open(path.string(), spec, config))
      return BadImage(
          name, absl::StrCat("not an image that can be read: ", OneLine(image.input->geterror())));
  }
  if (!image.input)
    return BadImage(name,
                    absl::StrCat("not an image that can be read: ", OneLine(OIIO::geterror())));
  image.spec = image.input->spec();
  STRATA_RETURN_IF_ERROR(CheckSize(name, image.spec, bytes));
  return image;
}

absl::StatusOr<OpenImage> Open(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    return absl::NotFoundError(absl::StrCat(path.string(), ": there is no such file"));
  if (!std::filesystem::is_regular_file(path, error)) return BadImage(path, "not a regular file");
  const uint64_t bytes = std::filesystem::file_size(path, error);
  if (error) return BadImage(path, error.message());
  return OpenAs(path, path, "", bytes);
}

absl::StatusOr<std::vector<float>> ReadValues(const std::filesystem::path& path,
                                              const OpenImage& image) {
  std::vector<float> values(static_cast<size_t>(image.spec.width) * image.spec.height *
                            image.spec.nchannels);
  if (!image.input->read_image(0, 0, 0, image.spec.nchannels, OIIO::TypeDesc::FLOAT, values.data()))
    return BadImage(path, absl::StrCat("the image is damaged or cut short: ",
                                       OneLine(image.input->geterror())));
  return values;
}

absl::StatusOr<ImageFile> ReadPixels(const std::filesystem::path& path, const OpenImage& image) {
  ImageFile file;
  file.width = image.spec.width;
  file.height = image.spec.height;
  file.channels = image.spec.nchannels;
  file.channel_names = image.spec.channelnames;
  file.eight_bit = image.spec.format == OIIO::TypeDesc::UINT8;
  file.sixteen_bit = image.spec.format == OIIO::TypeDesc::UINT16;
  STRATA_ASSIGN_OR_RETURN(file.values, ReadValues(path, image));
  return file;
}

absl::StatusOr<ImageFile> ReadOpenImage(const std::filesystem::path& path) {
  STRATA_ASSIGN_OR_RETURN(const OpenImage image, Open(path));
  return ReadPixels(path, image);
}

constexpr std::string_view kMetadataPrefix = "strata:";

absl::StatusOr<ImageLayers> ReadOpenExr(const std::filesystem::path& path) {
  STRATA_ASSIGN_OR_RETURN(const OpenImage image, Open(path));
  if (std::string_view(image.input->format_name()) != "openexr")
    return BadImage(path, "not an OpenEXR file");
  const OIIO::ImageSpec& spec = image.spec;
  ImageLayers layers;
  layers.full_width = spec.full_width;
  layers.full_height = spec.full_height;
  layers.crop = {spec.x - spec.full_x, spec.y - spec.full_y, spec.x - spec.full_x + spec.width,
                 spec.y - spec.full_y + spec.height};
  STRATA_ASSIGN_OR_RETURN(const std::vector<float> values, ReadValues(path, image));

  // Channels of no layer first; OpenImageIO has already put R, G, B, A of each layer in order.
  std::vector<int> order(spec.nchannels);
  for (int i = 0; i < spec.nchannels; ++i) order[i] = i;
  std::stable_partition(order.begin(), order.end(),
                        [&](int i) { return spec.channelnames[i].find('.') == std::string::npos; });
  for (const int channel : order) layers.channels.push_back(spec.channelnames[channel]);
  layers.values.reserve(values.size());
  for (size_t pixel = 0; pixel < values.size(); pixel += spec.nchannels) {
    for (const int channel : order) layers.values.push_back(values[pixel + channel]);
  }
  for (const OIIO::ParamValue& attribute : spec.extra_attribs) {
    const std::string name = attribute.name().string();
    if (name.rfind(kMetadataPrefix, 0) == 0)
      layers.metadata.emplace_back(name.substr(kMetadataPrefix.size()), attribute.get_string());
  }
  return layers;
}

/// Runs `read`; OpenImageIO's readers may throw on hostile files.
template <typename Read>
auto WithoutExceptions(const std::filesystem::path& path, Read read) -> decltype(read(path)) {
  try {
    return read(path);
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(
        absl::StrCat(path.string(), ": not enough memory for the image"));
  } catch (const std::exception& e) {
    return BadImage(path, absl::StrCat("the image is damaged: ", OneLine(e.what())));
  }
}

/// Writes under a temporary name beside `path` and renames, so that no reader sees half a file.
absl::Status WriteImage(const std::filesystem::path& path, const char* format,
                        const OIIO::ImageSpec& spec, OIIO::TypeDesc type, const void* values) {
  const auto failed = [&](const std::string& why) {
    return absl::UnknownError(absl::StrCat(path.string(), ": cannot be written: ", why));
  };
  std::filesystem::path temporary = path;
  temporary += ".part";
  std::error_code error;
  try {
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(format);
    if (!output) return failed(OneLine(OIIO::geterror()));
    if (!output->open(temporary.string(), spec) || !output->write_image(type, values) ||
        !output->close()) {
      const std::string why = OneLine(output->geterror());
      std::filesystem::remove(temporary, error);
      return failed(why);
    }
  } catch (const std::exception& e) {
    std::filesystem::remove(temporary, error);
    return failed(OneLine(e.what()));
  }
  std::filesystem::rename(temporary, path, error);
  if (error) {
    const std::string why = error.message();
    std::filesystem::remove(temporary, error);
    return failed(why);
  }
  return absl::OkStatus();
}

absl::Status CheckLayers(const std::filesystem::path& path, const ImageLayers& image) {
  const PixelRect& crop = image.crop;
  const size_t pixels =
      crop.Width() > 0 && crop.Height() > 0 ? static_cast<size_t>(crop.Width()) * crop.Height() : 0;
  if (pixels == 0 || image.channels.empty() ||
      image.values.size() != pixels * image.channels.size())
    return absl::InternalError(
        absl::StrCat(path.string(), ": the image has no pixels or not as many as its crop says"));
  return absl::OkStatus();
}

/// Bytes as a file of no folder; its path is valid as long as it lives.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view bytes) : file_(memfd_create("image", MFD_CLOEXEC)) {
    while (file_ >= 0 && !bytes.empty()) {
      const ssize_t written = write(file_, bytes.data(), bytes.size());
      if (written <= 0) return;
      bytes.remove_prefix(static_cast<size_t>(written));
    }
    whole_ = file_ >= 0;
  }
  ~MemoryFile() {
    if (file_ >= 0) close(file_);
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  bool ok() const { return whole_; }
  std::string path() const { return absl::StrCat("/proc/self/fd/", file_); }

 private:
  const int file_;
  bool whole_ = false;
};

}  // namespace

absl::StatusOr<ImageFile> ReadImageFile(const std::filesystem::path& path) {
  return WithoutExceptions(path, ReadOpenImage);
}

absl::StatusOr<ImageFile> ReadImageBytes(const std::string& name, std::string_view bytes) {
  const bool png = bytes.substr(0, 4) == "\x89PNG", jpeg = bytes.substr(0, 2) == "\xff\xd8";
  if (!png && !jpeg) return BadImage(name, "neither PNG nor JPEG");
  // OpenImageIO 2.4 reads JPEG from files alone; this one lies in memory and has no name.
  const MemoryFile memory(bytes);
  if (!memory.ok())
    return absl::ResourceExhaustedError(absl::StrCat(name, ": not enough memory for the image"));
  return WithoutExceptions(name, [&](const std::filesystem::path&) -> absl::StatusOr<ImageFile> {
    STRATA_ASSIGN_OR_RETURN(const OpenImage image,
                            OpenAs(name, memory.path(), png ? "png" : "jpeg", bytes.size()));
    return ReadPixels(name, image);
  });
}

absl::StatusOr<ImageLayers> ReadExr(const std::filesystem::path& path) {
  return WithoutExceptions(path, ReadOpenExr);
}

absl::Status WriteExr(const std::filesystem::path& path, const ImageLayers& image) {
  STRATA_RETURN_IF_ERROR(CheckLayers(path, image));
  OIIO::ImageSpec spec(image.crop.Width(), image.crop.Height(),
                       static_cast<int>(image.channels.size()), OIIO::TypeDesc::FLOAT);
  spec.x = image.crop.x0;
  spec.y = image.crop.y0;
  spec.full_x = spec.full_y = 0;
  spec.full_width = image.full_width;
  spec.full_height = image.full_height;
  spec.channelnames = image.channels;
  spec.attribute("compression", "zip");
  for (const auto& [name, value] : image.metadata)
    spec.attribute(absl::StrCat(std::string(kMetadataPrefix), name), value);
  return WriteImage(path, "openexr", spec, OIIO::TypeDesc::FLOAT, image.values.data());
}

float ToneMap(float x) {
  constexpr float kKnee = 0.8f, kShoulder = 1 - kKnee;
  if (!(x > 0)) return 0;
  if (x <= kKnee) return x;
  const float y = (x - kKnee) / kShoulder;
  return std::isinf(y) ? 1 : kKnee + kShoulder * (y / (1 + y));
}

absl::Status WritePng(const std::filesystem::path& path, const ImageLayers& image) {
  STRATA_RETURN_IF_ERROR(CheckLayers(path, image));
  const size_t channels = image.channels.size();
  size_t color[3];
  for (int i = 0; i < 3; ++i) {
    const char* const names[3] = {"R", "G", "B"};
    const auto found = std::find(image.channels.begin(), image.channels.end(), names[i]);
    if (found == image.channels.end())
      return absl::InvalidArgumentError(
          absl::StrCat(path.string(), ": the image has no channel ", names[i]));
    color[i] = static_cast<size_t>(found - image.channels.begin());
  }
  std::vector<uint8_t> codes;
  codes.reserve(image.values.size() / channels * 3);
  for (size_t pixel = 0; pixel < image.values.size(); pixel += channels) {
    for (const size_t channel : color) {
      const float linear = ToneMap(image.values[pixel + channel]);
      const float encoded =
          linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
      codes.push_back(static_cast<uint8_t>(std::min(encoded, 1.0f) * 255 + 0.5f));
    }
  }
  OIIO::ImageSpec spec(image.crop.Width(), image.crop.Height(), 3, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  return WriteImage(path, "png", spec, OIIO::TypeDesc::UINT8, codes.data());
}

}  // namespace strata
