#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/image_file.h"
#include "common/job.h"
#include "worker/math/transform.h"
#include "worker/math/vec.h"

// A scene as its file describes it: plain data, made by a reader (worker/pbrt), consumed once by
// the builders of geometry, lights and materials. Ids are indices into SceneDescription's vectors.
// Colours are linear Rec.709; lengths are scene units; angles are degrees where the file has them.

namespace strata {

struct SourceLocation {
  std::string file;  ///< As named by the user or the including file.
  int line = 0;
  std::string element;  ///< Of a JSON file, instead of a line: "materials[2].normalTexture".
  std::string ToString() const {
    return file + ":" + (element.empty() ? std::to_string(line) : element);
  }
};

/// Something read but not rendered as the file asks. The picture stays meaningful.
struct SceneWarning {
  SourceLocation where;
  std::string text;  ///< What is not supported and what is done instead.
};

// ---- textures: evaluate to an Rgb; where a number is wanted its r component is used ----

using TextureId = int32_t;
inline constexpr TextureId kNoTexture = -1;

/// (s, t) = (su * u + s_v * v + du, t_u * u + sv * v + dv); without the mixed terms pbrt's "uv"
/// mapping.
struct UvMapping {
  float su = 1, sv = 1, du = 0, dv = 0;
  float s_v = 0, t_u = 0;
};
/// kMirror repeats, every second time mirrored.
enum class ImageWrap { kRepeat, kBlack, kClamp, kMirror };
enum class ImageEncoding { kSrgb, kLinear, kGamma };  ///< Of 8-bit files; others are linear.

struct ConstantTexture {
  Rgb value;
};
/// An image that is no file of its own: the bytes of an image file inside another, or pixels that a
/// reader made.
using EmbeddedImage = std::variant<std::string, ImageFile>;

struct ImageTexture {
  std::string
      path;  ///< In the bundle; names it alone if `embedded`. Row 0 of the image is at t = 1.
  UvMapping mapping;
  ImageWrap wrap = ImageWrap::kRepeat;
  ImageEncoding encoding = ImageEncoding::kSrgb;
  float gamma = 2.2f;  ///< For kGamma.
  float scale = 1;
  bool invert = false;   ///< 1 - value, after `scale` (as pbrt: clamped at 0).
  bool nearest = false;  ///< No filtering ("point"); bilinear otherwise.
  /// A float texture: in all of r, g, b the alpha channel if the image has one that is not 1
  /// everywhere, as pbrt-v4, else the mean of the channels.
  bool scalar = false;
  bool alpha = false;  ///< The alpha channel in all of r, g, b, never encoded; 1 if there is none.
  SourceLocation where;  ///< That names the image.
  std::shared_ptr<const EmbeddedImage> embedded = nullptr;
  std::optional<ImageWrap> wrap_t = std::nullopt;  ///< Along t, where it is not `wrap`.
  /// 0 to 2: that channel alone, in all of r, g, b.
  std::optional<int> channel = std::nullopt;
  bool second_uv = false;  ///< Looked up by the second texture coordinates of meshes that have any.
};
struct ScaleTexture {
  TextureId texture = kNoTexture, scale = kNoTexture;
};
struct MixTexture {
  TextureId a = kNoTexture, b = kNoTexture, amount = kNoTexture;  ///< (1-amount) a + amount b.
};
struct CheckerboardTexture {
  TextureId a = kNoTexture, b = kNoTexture;
  UvMapping mapping;
  bool solid = false;          ///< 3-D: cells of unit size in texture space.
  Transform world_to_texture;  ///< For `solid`.
};
/// The corners (0, 0), (1, 0), (0, 1) and (1, 1) of texture space, bilinearly between and beyond.
struct BilinearTexture {
  std::array<TextureId, 4> corners = {kNoTexture, kNoTexture, kNoTexture, kNoTexture};
  UvMapping mapping;
};
/// `inside` in random dots, of which two in five unit cells of texture space have one.
struct DotsTexture {
  TextureId inside = kNoTexture, outside = kNoTexture;
  UvMapping mapping;
};
/// Noise of a point in texture space; see worker/geometry/noise.h.
struct NoiseTexture {
  enum class Kind { kFbm, kWrinkled, kWindy, kMarble };
  Kind kind = Kind::kFbm;
  int octaves = 8;                    ///< 0 to 32; not of kWindy.
  float roughness = 0.5f;             ///< By how much each octave is weaker; not of kWindy.
  float scale = 1, variation = 0.2f;  ///< Of kMarble: of space, and of the noise.
  Transform world_to_texture;
};
using TextureDescription =
    std::variant<ConstantTexture, ImageTexture, ScaleTexture, MixTexture, CheckerboardTexture,
                 BilinearTexture, DotsTexture, NoiseTexture>;

// ---- materials; every parameter is a texture so that constants need no second case ----

using MaterialId = int32_t;

/// Roughness as pbrt gives it; `remap` turns it into GGX alpha = sqrt(roughness).
struct Roughness {
  TextureId u = kNoTexture, v = kNoTexture;  ///< kNoTexture: 0, smooth.
  bool remap = true;
};
struct DiffuseMaterial {
  TextureId reflectance = kNoTexture;
};
struct ConductorMaterial {
  TextureId eta = kNoTexture, k = kNoTexture;
  TextureId reflectance =
      kNoTexture;  ///< If set: eta 1 and the k that gives this at normal incidence.
  Roughness roughness;
};
struct DielectricMaterial {
  float eta = 1.5f;
  Roughness roughness;
};
struct ThinDielectricMaterial {
  float eta = 1.5f;
};
/// A dielectric coat over a base; between them an absorbing or clear layer.
struct CoatedDiffuseMaterial {
  TextureId reflectance = kNoTexture;
  Roughness roughness;
  float eta = 1.5f;
  TextureId albedo = kNoTexture;  ///< Single-scattering albedo of the layer; 0 scatters nothing.
  float thickness = 0.01f;
};
struct CoatedConductorMaterial {
  Roughness interface_roughness, conductor_roughness;
  float interface_eta = 1.5f;
  TextureId eta = kNoTexture, k = kNoTexture, reflectance = kNoTexture;
};
struct DiffuseTransmissionMaterial {
  TextureId reflectance = kNoTexture, transmittance = kNoTexture;
  float scale = 1;
};
/// Microfacets of Blinn's distribution; a dielectric has k 0.
struct BlinnMaterial {
  TextureId eta = kNoTexture, k = kNoTexture;
  TextureId reflectance = kNoTexture;  ///< As that of ConductorMaterial.
  TextureId exponent = kNoTexture;
};
/// Ashikhmin and Shirley's anisotropic Phong model.
struct AshikhminShirleyMaterial {
  TextureId reflectance = kNoTexture, specular = kNoTexture;  ///< Rd and Rs.
  TextureId u_exponent = kNoTexture, v_exponent = kNoTexture;
};
/// glTF 2.0's surface: MetallicRoughnessBsdf says what it does with light. Colours and numbers are
/// cut to [0, 1]; kNoTexture is what is said beside.
struct MetallicRoughnessMaterial {
  TextureId base_color = kNoTexture;      ///< White.
  TextureId metallic = kNoTexture;        ///< 1.
  TextureId roughness = kNoTexture;       ///< 1; its square is GGX's alpha.
  float f0 = 0.04f;                       ///< Of the dielectric at normal incidence, 0 to 1.
  TextureId specular = kNoTexture;        ///< 1.
  TextureId specular_color = kNoTexture;  ///< White.
  TextureId transmission = kNoTexture;    ///< 0.
  TextureId coat = kNoTexture;            ///< 0.
  TextureId coat_roughness = kNoTexture;  ///< 0.
};
struct MixMaterial {
  MaterialId a = 0, b = 0;
  TextureId amount = kNoTexture;  ///< Of b.
  /// Every point scatters as the weighted sum of both; else it has one of them, chosen at random.
  bool sum = false;
};
/// No surface at all, at most the border of a medium. Shapes of it are left out of the geometry.
struct InterfaceMaterial {};
using MaterialDescription =
    std::variant<DiffuseMaterial, ConductorMaterial, DielectricMaterial, ThinDielectricMaterial,
                 CoatedDiffuseMaterial, CoatedConductorMaterial, DiffuseTransmissionMaterial,
                 BlinnMaterial, AshikhminShirleyMaterial, MetallicRoughnessMaterial, MixMaterial,
                 InterfaceMaterial>;

/// What turns the shading normal of a material away from that of the shape, without moving the
/// surface. At most one of the two maps is set.
struct SurfaceDetail {
  /// A tangent-space normal map (PBRT 10.5.3), linear: n = 2 (r, g, b) - 1 has its x along dp/du,
  /// its z along the shading normal and its y along their cross product.
  TextureId normal_map = kNoTexture;
  float normal_scale = 1;  ///< Of n.x and n.y.
  /// y towards growing v, also where the texture lies mirrored on the surface (glTF); else always
  /// along normal x dp/du (pbrt).
  bool y_along_v = false;
  /// A bump map (PBRT 10.5.2): r is a height along the shading normal, in units of the shape's
  /// space after all transforms.
  TextureId displacement = kNoTexture;

  bool Any() const { return normal_map != kNoTexture || displacement != kNoTexture; }
};

// ---- participating media ----

using MediumId = int32_t;
inline constexpr MediumId kNoMedium = -1;  ///< Empty space.

/// The same everywhere. Coefficients are per scene unit, not negative.
struct MediumDescription {
  SourceLocation where;
  Rgb absorption, scattering;
  Rgb emission;  ///< Radiance that a unit of length emits, over the absorption.
  float g = 0;   ///< In (-1, 1): the mean cosine of Henyey and Greenstein's phase function.
};
/// What lies on the two sides of a surface.
struct MediumBorder {
  MediumId inside = kNoMedium, outside = kNoMedium;  ///< The normal points outside.
  auto operator<=>(const MediumBorder&) const = default;
};

// ---- shapes, in their own space, placed by `to_world` ----

struct TriangleMeshShape {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;  ///< Empty, or one for each position.
  std::vector<Vec2f> uvs;      ///< Empty, or one for each position.
  std::vector<std::array<uint32_t, 3>> triangles;
  /// Bundle path of a PLY file that all this is yet to be read from; empty once the reader is done.
  std::string unread_file;
  /// Empty, or one for each position: see ImageTexture::second_uv. Tangents are those of `uvs`.
  std::vector<Vec2f> second_uvs;
};
struct SphereShape {
  float radius = 1, z_min = -1, z_max = 1, phi_max = 360;
};
struct DiskShape {
  float height = 0, radius = 1, inner_radius = 0, phi_max = 360;
};
struct CylinderShape {
  float radius = 1, z_min = -1, z_max = 1, phi_max = 360;
};
struct BilinearPatchShape {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;
  std::vector<Vec2f> uvs;
  std::vector<std::array<uint32_t, 4>> patches;  ///< Corners p00, p10, p01, p11.
};
/// How a curve has its width: across each ray, all around, or across its normals.
enum class CurveKind { kFlat, kCylinder, kRibbon };
/// Any number of curves, as segments of cubic Bezier curves.
struct CurveShape {
  CurveKind kind = CurveKind::kFlat;
  std::vector<Vec3f> positions;    ///< Control points.
  std::vector<float> radii;        ///< Half the width, for each control point.
  std::vector<Vec3f> normals;      ///< Ribbons: for each control point.
  std::vector<uint32_t> segments;  ///< The first of four consecutive control points each.
};
using ShapeGeometry = std::variant<TriangleMeshShape, SphereShape, DiskShape, CylinderShape,
                                   BilinearPatchShape, CurveShape>;

/// Emission of a shape. Radiance leaves the side the surface normal points to, or both.
struct AreaEmission {
  Rgb radiance;
  bool two_sided = false;
  /// If set: multiplies the radiance, at the point's (u, v). What is negative in it counts as 0.
  /// Its images are all of one pair of texture coordinates.
  TextureId texture = kNoTexture;
};

/// Which part of a surface is there: a ray that meets a point goes on with the probability 1 -
/// alpha as if there were none.
struct AlphaMask {
  TextureId texture = kNoTexture;  ///< r is alpha; kNoTexture: 1 everywhere.
  std::optional<float> cutoff;     ///< If set, alpha counts as 1 from here on and as 0 below.
  bool operator==(const AlphaMask&) const = default;
};

struct ShapeDescription {
  SourceLocation where;
  ShapeGeometry geometry;
  Transform to_world;
  MaterialId material = 0;
  bool reverse_orientation = false;
  std::optional<AreaEmission> emission;
  AlphaMask alpha;
  /// What it parts. Rays that cross a shape without stay in their medium.
  std::optional<MediumBorder> border;
};

/// Shapes that are placed by instances; their to_world leads to the object's space.
struct ObjectDescription {
  std::string name;
  std::vector<ShapeDescription> shapes;
};
struct InstanceDescription {
  SourceLocation where;
  int32_t object = 0;
  Transform to_world;
  std::optional<Transform> to_world_at_end;  ///< At time 1, if it moves: see MotionSteps.
};

// ---- lights other than emissive shapes ----

struct PointLightDescription {
  Vec3d position;  ///< World.
  Rgb intensity;
};
/// Full intensity up to falloff_start from the axis, none from cone_angle on.
struct SpotLightDescription {
  Vec3d position;                             ///< World.
  Vec3f direction;                            ///< World, unit, away from the light.
  float cone_angle = 30, falloff_start = 25;  ///< Degrees; at most 180, falloff_start no more.
  Rgb intensity;                              ///< Along the axis.
};
/// A picture's pixels are intensities. Light space: x to its right, y up, z forward.
struct ProjectionLightDescription {
  std::string path;  ///< In the bundle.
  Transform to_world;
  float fov = 90;  ///< Degrees, of the picture's shorter side.
  float scale = 1;
  std::optional<double> power;  ///< If set: luminance of the power, whatever the scale.
};
/// How an image holds all directions: pbrt-v4's equal-area octahedral layout, or latitude and
/// longitude. kByShape: the former where the image is square, else the latter.
enum class EnvironmentMapping { kEqualArea, kLatLong, kByShape };
/// A measured lamp. Light space: y up.
struct GoniometricLightDescription {
  std::string path;  ///< In the bundle: an image or *.ies.
  Transform to_world;
  Rgb intensity;                ///< Multiplies the diagram's.
  std::optional<double> power;  ///< If set: luminance of the power, whatever the intensity's.
  /// Of an image, whose third axis is the light's y; not kByShape.
  EnvironmentMapping mapping = EnvironmentMapping::kEqualArea;
};
struct DistantLightDescription {
  Vec3f direction;  ///< World, unit, from the scene towards the light.
  Rgb irradiance;   ///< On a surface that faces it.
};
struct ConstantInfiniteLightDescription {
  Rgb radiance;
};
struct ImageInfiniteLightDescription {
  std::string path;  ///< In the bundle.
  Transform to_world;
  float scale = 1;
  EnvironmentMapping mapping = EnvironmentMapping::kEqualArea;
  /// World: a rectangle's corners in order, p0 to p3. If set, light comes through it alone, against
  /// (p3 - p0) x (p1 - p0), to points on that side of it.
  std::optional<std::array<Vec3d, 4>> portal;
};
struct LightDescription {
  SourceLocation where;
  std::variant<PointLightDescription, SpotLightDescription, ProjectionLightDescription,
               GoniometricLightDescription, DistantLightDescription,
               ConstantInfiniteLightDescription, ImageInfiniteLightDescription>
      light;
};

// ---- camera and defaults ----

enum class CameraKind { kPerspective, kOrthographic, kSpherical };

/// PBRT 5.2 and 5.3. Camera space: x right, y up, z forward.
struct CameraDescription {
  CameraKind kind = CameraKind::kPerspective;
  Transform camera_to_world;
  std::optional<Transform> camera_to_world_at_end;  ///< At time 1, if it moves: see MotionSteps.
  /// Times of motion, at 0 of which things are at their start and at 1 at their end. Before and
  /// after that they stand still.
  float shutter_open = 0, shutter_close = 1;
  float fov = 90;  ///< Perspective alone. Degrees, over the shorter edge of the window,
  bool fov_is_vertical = false;  ///< or over its height whatever its shape.
  float lens_radius = 0;         ///< Of a thin lens, not of spherical cameras. Scene units.
  float focal_distance = 1e6f;
  std::optional<float> frame_aspect;  ///< Width over height; from the frame if unset.
  /// x_min, x_max, y_min, y_max: in units of camera space for orthographic cameras.
  std::optional<std::array<float, 4>> screen_window;
  /// How a spherical camera's frame holds the directions around it; y is up.
  EnvironmentMapping spherical_mapping = EnvironmentMapping::kEqualArea;
  MediumId medium = kNoMedium;  ///< Where it stands.
};

/// What the file says of the frame; job options override it.
struct FrameDefaults {
  int width = 1280, height = 720;
  std::optional<PixelRect> crop;
  FilterSpec filter;
  SamplerKind sampler = SamplerKind::kSobol;
  uint32_t spp = 16;
  int max_depth = 5;
};

struct SceneDescription {
  FrameDefaults defaults;
  CameraDescription camera;
  std::vector<TextureDescription> textures;
  std::vector<MaterialDescription> materials;  ///< Never empty: 0 is pbrt's default, diffuse 0.5.
  /// Of the materials that have any. A mix has that of the material it chooses, a sum has its own.
  std::map<MaterialId, SurfaceDetail> surface_details;
  std::vector<MediumDescription> media;
  std::vector<ShapeDescription> shapes;
  std::vector<ObjectDescription> objects;
  std::vector<InstanceDescription> instances;
  std::vector<LightDescription> lights;
};

}  // namespace strata
