#include "worker/geometry/texture.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <variant>

#include "worker/geometry/image_texels.h"
#include "worker/geometry/noise.h"
#include "worker/geometry/plain_images.h"
#include "worker/math/vec3d.h"
#include "worker/scene/references.h"

namespace strata {
namespace {

/// A texture with what its file or table index was resolved to.
struct ImageNode {
  uint32_t texels = 0, table = 0;
  UvMapping mapping;
  ImageWrap wrap = ImageWrap::kRepeat, wrap_t = ImageWrap::kRepeat;
  float scale = 1;
  bool invert = false, nearest = false, scalar = false, second_uv = false;
  int channel = -1;  ///< 0 to 2, or -1 for all.
};
using TextureNode = std::variant<Rgb, ImageNode, ScaleTexture, MixTexture, CheckerboardTexture,
                                 BilinearTexture, DotsTexture, NoiseTexture>;

Vec2f Map(const UvMapping& mapping, Vec2f uv) {
  Vec2f st = {mapping.su * uv.x + mapping.du, mapping.sv * uv.y + mapping.dv};
  if (mapping.s_v != 0) st.x += mapping.s_v * uv.y;
  if (mapping.t_u != 0) st.y += mapping.t_u * uv.x;
  return st;
}

/// A coordinate brought to where pixel indices are small integers. NaN becomes the lower end.
float Reduce(float s, ImageWrap wrap) {
  if (wrap == ImageWrap::kRepeat) s -= std::floor(s);
  if (wrap == ImageWrap::kMirror) s = 1 - std::fabs(1 - (s - 2 * std::floor(0.5f * s)));
  return s >= -1 ? std::min(s, 2.0f) : -1.0f;
}

/// The pixel of index `i`, at most one image size outside; -1 for black.
int WrapIndex(int i, int size, ImageWrap wrap) {
  if (i >= 0 && i < size) return i;
  if (wrap == ImageWrap::kRepeat) return i < 0 ? (i % size + size) % size : i % size;
  // Beyond a mirrored border lies the pixel itself.
  return wrap != ImageWrap::kBlack ? std::clamp(i, 0, size - 1) : -1;
}

Rgb Texel(const ImageTexels& texels, const DecodeTable& table, int x, int y,
          const ImageNode& node) {
  x = WrapIndex(x, texels.width, node.wrap);
  y = WrapIndex(y, texels.height, node.wrap_t);
  return x < 0 || y < 0 ? Rgb{} : texels.At(x, y, table);
}

/// A point in an image, in pixels: x from the left, y from the top.
Vec2f PointIn(const ImageTexels& texels, const ImageNode& node, SurfaceUv uv) {
  const Vec2f st = Map(node.mapping, node.second_uv ? uv.second : uv.first);
  return {Reduce(st.x, node.wrap) * texels.width, Reduce(1 - st.y, node.wrap_t) * texels.height};
}

/// The upper left of the four pixels around a point, and where between their centres it lies.
struct Quadruple {
  int x, y;
  Vec2f fraction;
};
Quadruple Around(Vec2f point) {
  // Pixel centers are at half-integers.
  const float left = std::floor(point.x - 0.5f), top = std::floor(point.y - 0.5f);
  return {
      static_cast<int>(left), static_cast<int>(top), {point.x - 0.5f - left, point.y - 0.5f - top}};
}

Rgb Bilinear(Rgb top_left, Rgb top_right, Rgb bottom_left, Rgb bottom_right, Vec2f f) {
  return (1 - f.y) * ((1 - f.x) * top_left + f.x * top_right) +
         f.y * ((1 - f.x) * bottom_left + f.x * bottom_right);
}

Rgb LookUp(const ImageTexels& texels, const DecodeTable& table, const ImageNode& node,
           SurfaceUv uv) {
  const Vec2f point = PointIn(texels, node, uv);
  if (node.nearest)
    return Texel(texels, table, static_cast<int>(std::floor(point.x)),
                 static_cast<int>(std::floor(point.y)), node);
  const Quadruple at = Around(point);
  const auto texel = [&](int dx, int dy) {
    return Texel(texels, table, at.x + dx, at.y + dy, node);
  };
  return Bilinear(texel(0, 0), texel(1, 0), texel(0, 1), texel(1, 1), at.fraction);
}

Rgb Adjust(const ImageNode& node, Rgb value) {
  if (node.channel >= 0) {
    value = Rgb::Gray(node.channel == 0 ? value.r : node.channel == 1 ? value.g : value.b);
  } else if (node.scalar) {
    value = Rgb::Gray(Average(value));
  }
  value *= node.scale;
  if (!node.invert) return value;
  return {std::max(0.0f, 1 - value.r), std::max(0.0f, 1 - value.g), std::max(0.0f, 1 - value.b)};
}

/// Whether the cell is one of the first texture: the sum of the cell's indices is even.
bool IsFirstCell(const CheckerboardTexture& checkerboard, Vec2f uv, Vec3f p) {
  double sum = 0;
  if (checkerboard.solid) {
    const Vec3d q = checkerboard.world_to_texture.Point(ToDouble(p));
    sum = std::floor(q.x) + std::floor(q.y) + std::floor(q.z);
  } else {
    const Vec2f st = Map(checkerboard.mapping, uv);
    sum = std::floor(static_cast<double>(st.x)) + std::floor(static_cast<double>(st.y));
  }
  const double half = sum * 0.5;
  return half == std::floor(half);
}

std::vector<TextureId> ChildrenOf(const TextureDescription& texture) {
  std::vector<TextureId> children;
  ForEachInput(texture, [&](TextureId child) { children.push_back(child); });
  return children;
}

/// Whether it is the same everywhere where what it is made of is.
bool AddsNoPattern(const TextureDescription& texture) {
  return std::holds_alternative<ScaleTexture>(texture) ||
         std::holds_alternative<MixTexture>(texture);
}

}  // namespace

struct TextureSet::State {
  std::vector<TextureNode> nodes;
  std::vector<Vec2f> steps;     ///< Of each node: see Step.
  std::vector<char> second_uv;  ///< Of each node: whether it or a child needs it.
  std::vector<ImageTexels> images;
  std::vector<DecodeTable> tables;
  PlainImages plain;  ///< Of all nodes.

  Rgb Eval(TextureId id, SurfaceUv uv, Vec3f p) const;
  Vec2f StepOf(const TextureNode& node, const std::vector<TextureId>& children) const;
  bool IsConstant(TextureId id) const {
    return id == kNoTexture || std::holds_alternative<Rgb>(nodes[id]);
  }
};

Rgb TextureSet::State::Eval(TextureId id, SurfaceUv uv, Vec3f p) const {
  if (id == kNoTexture) return {};
  const TextureNode& node = nodes[id];
  if (const auto* constant = std::get_if<Rgb>(&node)) return *constant;
  if (const auto* image = std::get_if<ImageNode>(&node))
    return Adjust(*image, LookUp(images[image->texels], tables[image->table], *image, uv));
  if (const auto* scale = std::get_if<ScaleTexture>(&node)) {
    const Rgb factor = Eval(scale->scale, uv, p);
    return IsBlack(factor) ? Rgb{} : Eval(scale->texture, uv, p) * factor;
  }
  if (const auto* mix = std::get_if<MixTexture>(&node)) {
    const float amount = Eval(mix->amount, uv, p).r;
    if (amount == 0) return Eval(mix->a, uv, p);
    if (amount == 1) return Eval(mix->b, uv, p);
    return (1 - amount) * Eval(mix->a, uv, p) + amount * Eval(mix->b, uv, p);
  }
  if (const auto* checkerboard = std::get_if<CheckerboardTexture>(&node))
    return Eval(IsFirstCell(*checkerboard, uv.first, p) ? checkerboard->a : checkerboard->b, uv, p);
  if (const auto* bilinear = std::get_if<BilinearTexture>(&node)) {
    const auto corner = [&](size_t i) { return Eval(bilinear->corners[i], uv, p); };
    return Bilinear(corner(0), corner(1), corner(2), corner(3), Map(bilinear->mapping, uv.first));
  }
  if (const auto* dots = std::get_if<DotsTexture>(&node))
    return Eval(IsInDot(Map(dots->mapping, uv.first)) ? dots->inside : dots->outside, uv, p);
  const auto& noise = std::get<NoiseTexture>(node);
  return EvalNoise(noise, noise.world_to_texture.Point(ToDouble(p)));
}

/// Of images a pixel, of others pbrt-v4's step; of what is made of others the smallest of theirs.
Vec2f TextureSet::State::StepOf(const TextureNode& node,
                                const std::vector<TextureId>& children) const {
  constexpr float kStep = 0.0005f;
  Vec2f step = {kStep, kStep};
  if (const auto* image = std::get_if<ImageNode>(&node)) {
    const auto pixel = [](int size, float scale) {
      const float extent = 1 / (static_cast<float>(size) * std::fabs(scale));
      return extent < 1 ? extent : kStep;
    };
    step = {pixel(images[image->texels].width, image->mapping.su),
            pixel(images[image->texels].height, image->mapping.sv)};
  }
  bool first = true;
  for (const TextureId child : children) {
    if (IsConstant(child)) continue;
    const Vec2f other = steps[child];
    step = first ? other : Vec2f{std::min(step.x, other.x), std::min(step.y, other.y)};
    first = false;
  }
  return step;
}

namespace {

/// Resolves descriptions one by one, each after those it refers to.
class TextureLoader {
 public:
  TextureLoader(const std::vector<TextureDescription>& textures, const FileSource& source)
      : textures_(textures), source_(source), costs_(textures.size(), kUnvisited) {}

  /// The order in which every texture follows those it refers to; INVALID_ARGUMENT if there is none
  /// or if a texture would take too many look-ups.
  absl::StatusOr<std::vector<TextureId>> Order();

  absl::StatusOr<ImageNode> LoadImage(const ImageTexture& texture, std::vector<ImageTexels>* images,
                                      std::vector<DecodeTable>* tables);

 private:
  static constexpr int kUnvisited = 0, kInProgress = -1;
  /// Nodes evaluated for one look-up, which also bounds the depth of the evaluation.
  static constexpr int kMaxCost = 1000;

  absl::Status Visit(TextureId id, std::vector<TextureId>* order, int depth);
  uint32_t TableOf(ImageEncoding encoding, float gamma, std::vector<DecodeTable>* tables);

  const std::vector<TextureDescription>& textures_;
  const FileSource& source_;
  std::vector<int> costs_;
  /// Path, encoding, gamma, and whether it is of the alpha channel.
  using ImageKey = std::tuple<std::string, ImageEncoding, float, bool>;

  std::map<ImageKey, uint32_t> images_;
  std::map<std::string, bool> translucent_;  ///< Of each image read so far.
  std::map<std::pair<ImageEncoding, float>, uint32_t> tables_;
};

absl::StatusOr<std::vector<TextureId>> TextureLoader::Order() {
  std::vector<TextureId> order;
  order.reserve(textures_.size());
  for (size_t id = 0; id < textures_.size(); ++id)
    STRATA_RETURN_IF_ERROR(Visit(static_cast<TextureId>(id), &order, 0));
  return order;
}

absl::Status TextureLoader::Visit(TextureId id, std::vector<TextureId>* order, int depth) {
  const auto too_deep = [&] {
    return absl::InvalidArgumentError(
        absl::StrCat("texture ", id, " takes more than ", kMaxCost,
                     " other textures to evaluate, nest fewer of them"));
  };
  if (costs_[id] > 0) return absl::OkStatus();
  if (costs_[id] == kInProgress)
    return absl::InvalidArgumentError(
        absl::StrCat("texture ", id, " refers to itself, break the cycle"));
  if (depth > kMaxCost) return too_deep();
  costs_[id] = kInProgress;
  int cost = 1;
  for (const TextureId child : ChildrenOf(textures_[id])) {
    if (child == kNoTexture) continue;
    if (child < 0 || static_cast<size_t>(child) >= textures_.size())
      return absl::InvalidArgumentError(
          absl::StrCat("texture ", id, " refers to texture ", child, ", which does not exist"));
    STRATA_RETURN_IF_ERROR(Visit(child, order, depth + 1));
    cost += costs_[child];
    if (cost > kMaxCost) return too_deep();
  }
  costs_[id] = cost;
  order->push_back(id);
  return absl::OkStatus();
}

uint32_t TextureLoader::TableOf(ImageEncoding encoding, float gamma,
                                std::vector<DecodeTable>* tables) {
  const auto [table, is_new] =
      tables_.try_emplace({encoding, gamma}, static_cast<uint32_t>(tables->size()));
  if (is_new) tables->push_back(MakeDecodeTable(encoding, gamma));
  return table->second;
}

absl::StatusOr<ImageNode> TextureLoader::LoadImage(const ImageTexture& texture,
                                                   std::vector<ImageTexels>* images,
                                                   std::vector<DecodeTable>* tables) {
  ImageNode node;
  node.mapping = texture.mapping;
  node.wrap = texture.wrap;
  node.wrap_t = texture.wrap_t.value_or(texture.wrap);
  node.scale = texture.scale;
  node.invert = texture.invert;
  node.nearest = texture.nearest;
  node.scalar = texture.scalar;
  node.second_uv = texture.second_uv;
  node.channel = texture.channel.value_or(-1);

  const auto known = translucent_.find(texture.path);
  const auto wants_alpha = [&](bool translucent) {
    return texture.alpha || (texture.scalar && translucent);
  };
  bool alpha = known != translucent_.end() && wants_alpha(known->second);
  ImageEncoding encoding = alpha ? ImageEncoding::kLinear : texture.encoding;
  float gamma = encoding == ImageEncoding::kGamma ? texture.gamma : 0;
  if (known != translucent_.end()) {
    // Texels are shared whatever the encoding, unless it was applied to them.
    for (const ImageKey& key : {ImageKey{texture.path, ImageEncoding::kLinear, 0, alpha},
                                ImageKey{texture.path, encoding, gamma, alpha}}) {
      const auto same = images_.find(key);
      if (same == images_.end()) continue;
      node.texels = same->second;
      node.table = TableOf(encoding, gamma, tables);
      return node;
    }
  }
  absl::StatusOr<ImageFile> file = ReadTextureImage(texture, source_);
  const std::string what =
      absl::StrCat(texture.where.file.empty() ? "" : absl::StrCat(texture.where.ToString(), ": "),
                   "texture image ", texture.path);
  if (!file.ok()) return Annotate(file.status(), what);
  alpha = wants_alpha(translucent_[texture.path] = IsTranslucent(*file));
  encoding = alpha ? ImageEncoding::kLinear : texture.encoding;
  gamma = encoding == ImageEncoding::kGamma ? texture.gamma : 0;
  const absl::Status usable = CheckTexels(*file, alpha);
  if (!usable.ok()) return Annotate(usable, what);
  node.table = TableOf(encoding, gamma, tables);
  node.texels = static_cast<uint32_t>(images->size());
  images->push_back(alpha ? ImageTexels::AlphaFrom(*file)
                          : ImageTexels::From(*file, encoding, gamma));
  const bool encoded = file->sixteen_bit && !alpha;
  images_[{texture.path, encoded ? encoding : ImageEncoding::kLinear, encoded ? gamma : 0, alpha}] =
      node.texels;
  return node;
}

}  // namespace

TextureSet::TextureSet() = default;
TextureSet::~TextureSet() = default;

absl::StatusOr<std::unique_ptr<TextureSet>> TextureSet::Load(
    const std::vector<TextureDescription>& textures, const FileSource& source) {
  std::unique_ptr<TextureSet> set(new TextureSet);
  set->state_ = std::make_unique<State>();
  State& state = *set->state_;
  state.nodes.resize(textures.size());
  state.steps.resize(textures.size());
  state.second_uv.resize(textures.size());
  TextureLoader loader(textures, source);
  STRATA_ASSIGN_OR_RETURN(const std::vector<TextureId> order, loader.Order());
  for (const TextureId id : order) {
    TextureNode& node = state.nodes[id];
    const TextureDescription& texture = textures[id];
    if (const auto* image = std::get_if<ImageTexture>(&texture)) {
      STRATA_ASSIGN_OR_RETURN(node, loader.LoadImage(*image, &state.images, &state.tables));
    } else {
      std::visit(
          [&](const auto& t) {
            using T = std::remove_cvref_t<decltype(t)>;
            if constexpr (std::is_same_v<T, ConstantTexture>) node = t.value;
            if constexpr (std::is_constructible_v<TextureNode, T>) node = t;
          },
          texture);
    }
    const std::vector<TextureId> children = ChildrenOf(texture);
    state.steps[id] = state.StepOf(node, children);
    const auto* as_image = std::get_if<ImageNode>(&node);
    state.second_uv[id] = (as_image && as_image->second_uv) ||
                          std::any_of(children.begin(), children.end(), [&](TextureId child) {
                            return child != kNoTexture && state.second_uv[child];
                          });
    if (AddsNoPattern(texture) && std::all_of(children.begin(), children.end(),
                                              [&](TextureId c) { return state.IsConstant(c); }))
      node = state.Eval(id, {}, {});
  }
  for (size_t id = 0; id < textures.size(); ++id) {
    if (const auto* node = std::get_if<ImageNode>(&state.nodes[id]))
      state.plain.Add(state.images[node->texels], state.tables[node->table],
                      std::get<ImageTexture>(textures[id]));
    else
      state.plain.AddOther();
  }
  return set;
}

Rgb TextureSet::Eval(TextureId id, SurfaceUv uv, Vec3f p) const { return state_->Eval(id, uv, p); }

void TextureSet::Begin(IntLanes id, Vec2Lanes uv, MaskLanes mask, BegunLanes* begun) const {
  begun->lanes = mask;
  begun->uv = uv;
  state_->plain.Begin(id, uv, mask & (id != kNoTexture), &begun->plain);
}

RgbLanes TextureSet::Finish(const BegunLanes& begun, Vec3Lanes p) const {
  RgbLanes value = state_->plain.Finish(begun.plain);
  ForEachLane(begun.lanes & ~begun.plain.lanes, [&](int lane) {
    const Vec2f uv = {begun.uv.x[lane], begun.uv.y[lane]};
    value.Set(lane, state_->Eval(begun.plain.id[lane], uv, p.Get(lane)));
  });
  return value;
}

bool TextureSet::NeedsFirstUvOnly(TextureId id) const {
  return id == kNoTexture || !state_->second_uv[id];
}

Vec2f TextureSet::Step(TextureId id) const { return state_->steps[id]; }

bool TextureSet::IsConstant(TextureId id) const { return state_->IsConstant(id); }

}  // namespace strata
