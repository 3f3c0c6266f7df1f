#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/image_file.h"
#include "worker/geometry/image_texels.h"
#include "worker/light/spot_light.h"
#include "worker/math/vec3d.h"
#include "worker/pbrt/entities.h"

namespace strata {
namespace {

constexpr double kPiDouble = std::numbers::pi;

/// A photometric level such as "power", none if absent. As in pbrt-v4, it multiplies the light's
/// colour, and values of 0 and below stand for absent.
std::optional<double> Level(ParameterReader& parameters, std::string_view name) {
  const double value = parameters.Float(name, -1);
  return value > 0 ? std::optional<double>(value) : std::nullopt;
}

/// "scale", which no light has below 0.
double Scale(ParameterReader& parameters) {
  const double scale = parameters.Float("scale", 1);
  if (scale < 0) {
    parameters.Fail(parameters.where(),
                    StrCat("\"float scale\" of a light is ", scale, "; it must not be negative"));
  }
  return scale;
}

Rgb Scaled(ParameterReader& parameters, Rgb color, double scale) {
  const Rgb scaled = color * static_cast<float>(scale);
  if (!strata::IsFinite(scaled)) {
    parameters.Fail(parameters.where(), "the light is too bright; give it a smaller \"scale\"");
  }
  return scaled;
}

bool IsFinite(Vec3d v) { return strata::IsFinite(ToFloat(v)); }

absl::StatusOr<LightDescription> ReadPoint(const Transform& world_from_light,
                                           std::string_view color_space,
                                           ParameterReader& parameters, ReadContext& context) {
  const Rgb intensity =
      ColorParameter(parameters, "I", Rgb::Gray(1), SpectrumUse::kIlluminant, color_space, context);
  double scale = Scale(parameters);
  if (const std::optional<double> power = Level(parameters, "power")) {
    scale *= *power / (4 * kPiDouble);
  }
  const Vec3d from = world_from_light.Point(ToDouble(parameters.Point3("from").value_or(Vec3f{})));
  if (!IsFinite(from)) return ErrorAt(parameters.where(), "the light is infinitely far away");
  return LightDescription{parameters.where(),
                          PointLightDescription{from, Scaled(parameters, intensity, scale)}};
}

absl::StatusOr<LightDescription> ReadSpot(const Transform& world_from_light,
                                          std::string_view color_space, ParameterReader& parameters,
                                          ReadContext& context) {
  const SourceLocation& where = parameters.where();
  const Rgb intensity =
      ColorParameter(parameters, "I", Rgb::Gray(1), SpectrumUse::kIlluminant, color_space, context);
  double scale = Scale(parameters);
  SpotLightDescription spot;
  spot.cone_angle = static_cast<float>(parameters.Float("coneangle", 30));
  const float delta = static_cast<float>(parameters.Float("conedeltaangle", 5));
  if (!(spot.cone_angle > 0 && spot.cone_angle <= 180)) {
    parameters.Fail(where, StrCat("\"float coneangle\" is ", spot.cone_angle,
                                  "; it must be more than 0 and at most 180 degrees"));
  }
  if (!(delta >= 0)) {
    parameters.Fail(where, "\"float conedeltaangle\" must not be negative");
  }
  spot.falloff_start = std::max(spot.cone_angle - delta, 0.0f);
  if (const std::optional<double> power = Level(parameters, "power")) {
    scale *= *power / FalloffIntegral(VersineOfDegrees(spot.falloff_start),
                                      VersineOfDegrees(spot.cone_angle));
  }
  const Vec3f from = parameters.Point3("from").value_or(Vec3f{});
  const Vec3f to = parameters.Point3("to").value_or(Vec3f{0, 0, 1});
  spot.position = world_from_light.Point(ToDouble(from));
  if (!IsFinite(spot.position)) return ErrorAt(where, "the light is infinitely far away");
  const Vec3d direction = world_from_light.Vector(ToDouble(to) - ToDouble(from));
  const double length = Length(direction);
  if (!(length > 0) || !std::isfinite(length)) {
    return ErrorAt(where, "\"from\" and \"to\" of the light give no direction");
  }
  spot.direction = ToFloat(direction * (1 / length));
  spot.intensity = Scaled(parameters, intensity, scale);
  return LightDescription{where, spot};
}

/// The bundle path of "filename", which the light must have.
absl::StatusOr<std::string> ReadLightFile(ParameterReader& parameters, ReadContext& context) {
  const std::string name = parameters.String("filename", "");
  if (!parameters.Has("filename")) {
    parameters.Fail(parameters.where(),
                    StrCat(parameters.directive(), " wants a \"string filename\""));
  }
  STRATA_RETURN_IF_ERROR(parameters.Finish(context.warnings));
  return context.AddFile(name, parameters.where());
}

/// "mapping", of Strata alone: how the light's image holds all directions.
EnvironmentMapping ReadMapping(ParameterReader& parameters) {
  const std::string mapping = parameters.String("mapping", "equalarea");
  if (mapping == "equirectangular") return EnvironmentMapping::kLatLong;
  if (mapping != "equalarea") {
    parameters.Fail(parameters.where(), StrCat("unknown mapping \"", mapping,
                                               "\" of a light's image; use equalarea or "
                                               "equirectangular"));
  }
  return EnvironmentMapping::kEqualArea;
}

absl::Status CheckLightPlacement(const Transform& world_from_light, const SourceLocation& where) {
  if (world_from_light.Inverse() && IsFinite(world_from_light.Point({}))) return absl::OkStatus();
  return ErrorAt(where, "the light's transform cannot be inverted, or leads to no finite place");
}

absl::StatusOr<LightDescription> ReadProjection(const Transform& world_from_light,
                                                std::string_view /*color_space*/,
                                                ParameterReader& parameters, ReadContext& context) {
  const SourceLocation& where = parameters.where();
  STRATA_RETURN_IF_ERROR(CheckLightPlacement(world_from_light, where));
  ProjectionLightDescription projection;
  projection.to_world = world_from_light;
  projection.scale = static_cast<float>(Scale(parameters));
  projection.power = Level(parameters, "power");
  projection.fov = static_cast<float>(parameters.Float("fov", 90));
  if (!(projection.fov > 0 && projection.fov < 179.9f)) {
    parameters.Fail(where, StrCat("\"float fov\" is ", projection.fov,
                                  "; it must be more than 0 and less than 180 degrees"));
  }
  STRATA_ASSIGN_OR_RETURN(projection.path, ReadLightFile(parameters, context));
  return LightDescription{where, std::move(projection)};
}

absl::StatusOr<LightDescription> ReadGoniometric(const Transform& world_from_light,
                                                 std::string_view color_space,
                                                 ParameterReader& parameters,
                                                 ReadContext& context) {
  const SourceLocation& where = parameters.where();
  STRATA_RETURN_IF_ERROR(CheckLightPlacement(world_from_light, where));
  GoniometricLightDescription lamp;
  lamp.to_world = world_from_light;
  const Rgb intensity =
      ColorParameter(parameters, "I", Rgb::Gray(1), SpectrumUse::kIlluminant, color_space, context);
  lamp.intensity = Scaled(parameters, intensity, Scale(parameters));
  lamp.power = Level(parameters, "power");
  lamp.mapping = ReadMapping(parameters);
  STRATA_ASSIGN_OR_RETURN(lamp.path, ReadLightFile(parameters, context));
  return LightDescription{where, std::move(lamp)};
}

absl::StatusOr<LightDescription> ReadDistant(const Transform& world_from_light,
                                             std::string_view color_space,
                                             ParameterReader& parameters, ReadContext& context) {
  const Rgb radiance =
      ColorParameter(parameters, "L", Rgb::Gray(1), SpectrumUse::kIlluminant, color_space, context);
  double scale = Scale(parameters);
  scale *= Level(parameters, "illuminance").value_or(1);
  const Vec3f from = parameters.Point3("from").value_or(Vec3f{});
  const Vec3f to = parameters.Point3("to").value_or(Vec3f{0, 0, 1});
  const Vec3d direction = world_from_light.Vector(ToDouble(from - to));
  const double length =
      std::sqrt(direction.x * direction.x + direction.y * direction.y + direction.z * direction.z);
  if (!(length > 0) || !std::isfinite(length)) {
    return ErrorAt(parameters.where(), "\"from\" and \"to\" of the light give no direction");
  }
  const Vec3f unit = ToFloat({direction.x / length, direction.y / length, direction.z / length});
  return LightDescription{parameters.where(),
                          DistantLightDescription{unit, Scaled(parameters, radiance, scale)}};
}

absl::StatusOr<LightDescription> ReadInfinite(const Transform& world_from_light,
                                              std::string_view color_space,
                                              ParameterReader& parameters, ReadContext& context) {
  const SourceLocation& where = parameters.where();
  const double scale = Scale(parameters);
  const std::optional<double> illuminance = Level(parameters, "illuminance");
  const std::vector<Vec3f> portal = parameters.Point3s("portal");
  if (!parameters.Has("filename")) {
    if (!portal.empty()) {
      context.Warn(where, "the \"portal\" of a light without an image is ignored");
    }
    Rgb radiance = ColorParameter(parameters, "L", Rgb::Gray(1), SpectrumUse::kIlluminant,
                                  color_space, context);
    // The irradiance of a hemisphere of radiance L is pi L.
    if (illuminance) radiance = radiance * static_cast<float>(*illuminance / kPiDouble);
    return LightDescription{where,
                            ConstantInfiniteLightDescription{Scaled(parameters, radiance, scale)}};
  }
  if (parameters.Has("L")) {
    parameters.Fail(where, "an infinite light has either \"L\" or \"filename\", not both");
  }
  if (illuminance) {
    parameters.Fail(where, "\"illuminance\" of an image light is not supported; use \"scale\"");
  }
  if (!world_from_light.Inverse()) {
    return ErrorAt(where, "the light's transform cannot be inverted");
  }
  if (!portal.empty() && portal.size() != 4) {
    parameters.Fail(where,
                    StrCat("the \"portal\" has ", portal.size(), " corners; a rectangle has 4"));
  }
  const std::string name = parameters.String("filename", "");
  const EnvironmentMapping mapping = ReadMapping(parameters);
  STRATA_RETURN_IF_ERROR(parameters.Finish(context.warnings));
  STRATA_ASSIGN_OR_RETURN(std::string path, context.AddFile(name, where));
  ImageInfiniteLightDescription sky = {std::move(path), world_from_light, static_cast<float>(scale),
                                       mapping};
  // As in pbrt-v4, whatever the light's own space is.
  if (!portal.empty()) {
    sky.portal = {ToDouble(portal[0]), ToDouble(portal[1]), ToDouble(portal[2]),
                  ToDouble(portal[3])};
  }
  return LightDescription{where, std::move(sky)};
}

/// Of the image's pixels, as emission counts them: pbrt-v4 divides an area light's power by it.
absl::StatusOr<double> MeanLuminance(const ImageTexture& image, const ReadContext& context) {
  STRATA_ASSIGN_OR_RETURN(const std::filesystem::path path,
                          context.Locate(image.path, image.where));
  const absl::StatusOr<ImageFile> file = ReadImageFile(path);
  const absl::Status usable = file.ok() ? CheckTexels(*file, false) : file.status();
  if (!usable.ok()) return Annotate(usable, StrCat(image.where.ToString(), ": ", image.path));
  const DecodeTable table = MakeDecodeTable(image.encoding, image.gamma);
  const ImageTexels texels = ImageTexels::From(*file, image.encoding, image.gamma);
  double sum = 0;
  for (int y = 0; y < texels.height; ++y) {
    for (int x = 0; x < texels.width; ++x) {
      const Rgb c = texels.At(x, y, table);
      sum += Luminance({std::max(c.r, 0.0f), std::max(c.g, 0.0f), std::max(c.b, 0.0f)});
    }
  }
  const double mean = sum / (static_cast<double>(texels.width) * texels.height);
  if (!(mean > 0)) {
    return ErrorAt(image.where, StrCat("\"", image.path,
                                       "\" is black, so that no scale gives the "
                                       "light its \"power\"; leave that out"));
  }
  return mean;
}

}  // namespace

absl::Status ReadLight(const std::string& type, const Transform& world_from_light,
                       std::string_view color_space, ParameterReader& parameters,
                       ReadContext& context) {
  const auto read = type == "point"         ? ReadPoint
                    : type == "spot"        ? ReadSpot
                    : type == "projection"  ? ReadProjection
                    : type == "goniometric" ? ReadGoniometric
                    : type == "distant"     ? ReadDistant
                    : type == "infinite"    ? ReadInfinite
                                            : nullptr;
  if (!read) {
    return ErrorAt(parameters.where(), StrCat("LightSource \"", type,
                                              "\" is not supported; use point, spot, "
                                              "projection, goniometric, distant or infinite, or an "
                                              "area light"));
  }
  STRATA_ASSIGN_OR_RETURN(LightDescription light,
                          read(world_from_light, color_space, parameters, context));
  STRATA_RETURN_IF_ERROR(parameters.Finish(context.warnings));
  context.scene.lights.push_back(std::move(light));
  return absl::OkStatus();
}

absl::StatusOr<AreaLight> ReadAreaLight(const std::string& type, std::string_view color_space,
                                        ParameterReader& parameters, TextureTable& textures,
                                        ReadContext& context) {
  if (type != "diffuse") {
    return ErrorAt(parameters.where(),
                   StrCat("AreaLightSource \"", type, "\" is not supported; use diffuse"));
  }
  AreaLight light;
  light.where = parameters.where();
  Rgb radiance =
      ColorParameter(parameters, "L", Rgb::Gray(1), SpectrumUse::kIlluminant, color_space, context);
  const double scale = Scale(parameters);
  light.two_sided = parameters.Bool("twosided", false);
  light.power = Level(parameters, "power");
  if (parameters.Has("filename")) {
    if (parameters.Has("L")) {
      parameters.Fail(light.where, "an area light has either \"L\" or \"filename\", not both");
    }
    ImageTexture image;
    image.wrap = ImageWrap::kClamp;
    image.where = light.where;
    const std::string name = parameters.String("filename", "");
    STRATA_RETURN_IF_ERROR(parameters.Finish(context.warnings));
    STRATA_ASSIGN_OR_RETURN(image.path, context.NameFile(name, light.where));
    if (light.power) {
      STRATA_ASSIGN_OR_RETURN(const double mean, MeanLuminance(image, context));
      radiance = radiance * static_cast<float>(1 / mean);
    }
    light.image = textures.Image(std::move(image));
  }
  light.radiance = Scaled(parameters, radiance, scale);
  STRATA_RETURN_IF_ERROR(parameters.Finish(context.warnings));
  return light;
}

}  // namespace strata
