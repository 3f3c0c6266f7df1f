// Every kind of mistake in a scene is told with its place: file:line.

#include <gtest/gtest.h>

#include <string>

#include "tests/pbrt/scene_folder.h"

namespace strata {
namespace {

struct Mistake {
  std::string name;
  std::string text;    ///< Of scene.pbrt.
  int line;            ///< Where it is told.
  std::string phrase;  ///< Part of what is told.
};

void PrintTo(const Mistake& mistake, std::ostream* out) { *out << mistake.name; }

class MistakeTest : public testing::TestWithParam<Mistake> {};

TEST_P(MistakeTest, IsToldWithItsPlace) {
  const Mistake& mistake = GetParam();
  const absl::StatusOr<PbrtScene> scene = ReadText(mistake.text);
  ASSERT_FALSE(scene.ok()) << "the mistake is not seen";
  const std::string message(scene.status().message());
  EXPECT_EQ(message.find("scene.pbrt:" + std::to_string(mistake.line) + ": "), 0u) << message;
  EXPECT_NE(message.find(mistake.phrase), std::string::npos) << message;
}

std::string NameOf(const testing::TestParamInfo<Mistake>& info) { return info.param.name; }

/// `world` after a WorldBegin on line 1.
Mistake InWorld(std::string name, const std::string& world, int line, std::string phrase) {
  return {std::move(name), "WorldBegin\n" + world, line, std::move(phrase)};
}

INSTANTIATE_TEST_SUITE_P(
    Syntax, MistakeTest,
    testing::Values(
        Mistake{"UnknownDirective", "\nFrobnicate 1", 2, "is no directive"},
        Mistake{"StringAsDirective", "\"Camera\"", 1, "is no directive"},
        Mistake{"UnterminatedString", "Camera \"perspective\nWorldBegin", 1, "does not end"},
        Mistake{"UnknownEscape", "Camera \"per\\qspective\"", 1, "unknown escape"},
        Mistake{"MissingString", "\n\nCamera 3", 3, "wants a string"},
        Mistake{"UnknownParameterType", "Camera \"perspective\"\n \"flot fov\" 3", 2,
                "is no parameter"},
        Mistake{"ParameterWithoutName", "Camera \"perspective\"\n \"float\" 3", 2,
                "is no parameter"},
        Mistake{"MissingBracket", "Camera \"perspective\"\n \"float fov\" [ 3", 2, "lack a ]"},
        Mistake{"NestedBracket", "Camera \"perspective\" \"float fov\" [ [ 3 ] ]", 1, "lack a ]"},
        Mistake{"NoValue", "Camera \"perspective\" \"float fov\"", 1, "wants 1 value"},
        Mistake{"TwoValues", "Camera \"perspective\" \"float fov\" [1 2]", 1, "wants 1 value"},
        Mistake{"ParameterTwice", "Film \"rgb\" \"float iso\" 1\n\"float iso\" 2", 2,
                "given twice"},
        Mistake{"WordAsNumber", "Camera \"perspective\" \"float fov\" wide", 1, "is no number"},
        Mistake{"StringAsNumber", "Camera \"perspective\" \"float fov\" \"3\"", 1, "wants numbers"},
        Mistake{"NumberAsString", "Film \"rgb\" \"string filename\" 3", 1, "in quotes"},
        Mistake{"NotANumber", "Camera \"perspective\"\n\"float fov\" [\nnan ]", 3, "not finite"},
        Mistake{"Infinite", "Camera \"perspective\" \"float fov\" inf", 1, "not finite"},
        Mistake{"TooLarge", "Translate 0 0 1e39", 1, "too large"},
        Mistake{"FarTooLarge", "Translate 0 0 1e999", 1, "too large"},
        Mistake{"FractionalInteger", "Film \"rgb\" \"integer xresolution\" 1.5", 1, "no integer"},
        Mistake{"WrongType", "Camera \"perspective\" \"integer fov\" 35", 1, "wants \"float fov\""},
        Mistake{"BadBool", "Integrator \"path\" \"bool regularize\" 1", 1, "true or false"},
        Mistake{"IncompleteTriple", "WorldBegin Shape \"trianglemesh\" \"point3 P\" [ 1 2 ]", 1,
                "no multiple of 3"}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    Scopes, MistakeTest,
    testing::Values(
        Mistake{"NoWorld", "\nFilm \"rgb\"\n", 2, "no WorldBegin"},
        Mistake{"ShapeBeforeWorld", "Shape \"sphere\"", 1, "after WorldBegin"},
        InWorld("CameraInWorld", "Camera \"perspective\"", 2, "before WorldBegin"),
        InWorld("WorldTwice", "WorldBegin", 2, "before WorldBegin"),
        InWorld("UnclosedAttribute", "\nAttributeBegin", 3, "never ends"),
        InWorld("EndWithoutBegin", "AttributeEnd", 2, "without AttributeBegin"),
        InWorld("MismatchedEnd", "AttributeBegin\nObjectEnd", 3, "scene.pbrt:2"),
        InWorld("NestedObject", "ObjectBegin \"a\"\nObjectBegin \"b\"", 3, "inside another"),
        InWorld("InstanceInObject", "ObjectBegin \"a\"\nObjectInstance \"a\"", 3, "inside"),
        InWorld("ObjectTwice", "ObjectBegin \"a\" ObjectEnd\nObjectBegin \"a\" ObjectEnd", 3,
                "twice"),
        InWorld("UnknownObject", "\nObjectInstance \"a\"", 3, "no object \"a\""),
        InWorld("LightInObject", "ObjectBegin \"a\"\nLightSource \"point\"", 3, "part of an"),
        InWorld("UnknownAttributeTarget", "Attribute \"camera\"", 2, "Attribute wants")),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    Transforms, MistakeTest,
    testing::Values(
        Mistake{"ShortTransform", "Transform [ 1 0 0 0 ]", 1, "wants 16 numbers"},
        Mistake{"LongTransform", "Translate [ 1 0 0 0 ]", 1, "3 numbers and a ]"},
        Mistake{"SingularCamera",
                "Transform [ 0 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 ]\nCamera \"perspective\"", 2,
                "cannot be inverted"},
        Mistake{"ZeroScale", "Scale 1 0 1", 1, "by 0"},
        Mistake{"ZeroAxis", "Rotate 30 0 0 0", 1, "axis"},
        Mistake{"LookAtItself", "LookAt 1 1 1  1 1 1  0 1 0", 1, "apart"},
        Mistake{"LookAlongUp", "LookAt 0 0 0  0 1 0  0 1 0", 1, "up vector"},
        Mistake{"UnknownSystem", "CoordSysTransform \"nowhere\"", 1, "no coordinate system"},
        InWorld("SingularShape",
                "ConcatTransform [ 1 0 0 0  0 0 0 0  0 0 1 0  0 0 0 1 ]\nShape \"sphere\"", 3,
                "cannot be inverted"),
        InWorld("SingularInstance",
                "ObjectBegin \"a\" ObjectEnd ConcatTransform [ 1 0 0 0  0 0 0 0  0 0 1 0  0 0 0 1 ]"
                "\nObjectInstance \"a\"",
                3, "cannot be inverted"),
        InWorld("FarAway", "Translate 3e38 0 0\nShape \"sphere\"", 3, "too far"),
        InWorld("Runaway",
                "Scale 1e38 1e38 1e38 Scale 1e38 1e38 1e38 Scale 1e38 1e38 1e38 Scale 1e38 1e38 "
                "1e38 Scale 1e38 1e38 1e38 Scale 1e38 1e38 1e38 Scale 1e38 1e38 1e38 Scale 1e38 "
                "1e38 1e38 Scale 1e38 1e38 1e38",
                2, "beyond all bounds")),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    Frame, MistakeTest,
    testing::Values(
        Mistake{"OtherCamera", "Camera \"realistic\"", 1, "use perspective"},
        Mistake{"WideFov", "Camera \"perspective\" \"float fov\" 180", 1, "180 degrees"},
        Mistake{"NegativeLens", "Camera \"perspective\" \"float lensradius\" -1", 1, "negative"},
        Mistake{"BadWindow", "Camera \"perspective\" \"float screenwindow\" [ 1 -1 -1 1 ]", 1,
                "x0 < x1"},
        Mistake{"OtherFilm", "Film \"papyrus\"", 1, "use rgb"},
        Mistake{"NoPixels", "Film \"rgb\" \"integer xresolution\" 0", 1, "1 to 65536"},
        Mistake{"EmptyCrop", "Film \"rgb\" \"float cropwindow\" [ 0.5 0.5 0 1 ]", 1, "no pixels"},
        Mistake{"OtherFilter", "PixelFilter \"lanczos\"", 1, "unknown PixelFilter"},
        Mistake{"ZeroRadius", "PixelFilter \"box\" \"float xradius\" 0", 1, "more than 0"},
        Mistake{"OtherSampler", "Sampler \"dice\"", 1, "unknown Sampler"},
        Mistake{"OtherRandomization", "Sampler \"sobol\" \"string randomization\" \"dice\"", 1,
                "unknown randomization"},
        Mistake{"NoSamples", "Sampler \"sobol\" \"integer pixelsamples\" 0", 1, "1 to 1e9"},
        Mistake{"NegativeDepth", "Integrator \"path\" \"integer maxdepth\" -1", 1, "negative"},
        Mistake{"OtherColorSpace", "ColorSpace \"aces2065-1\"", 1, "not supported"}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    Surfaces, MistakeTest,
    testing::Values(
        InWorld("OtherTextureClass", "Texture \"t\" \"float\" \"ptex\"", 2, "is not supported"),
        InWorld("OtherTextureType", "Texture \"t\" \"vector\" \"constant\"", 2,
                "float or spectrum"),
        InWorld("Octaves", "Texture \"t\" \"float\" \"fbm\" \"integer octaves\" 33", 2, "0 to 32"),
        InWorld("UnknownTexture", "Material \"diffuse\"\n\"texture reflectance\" \"t\"", 3,
                "no spectrum texture \"t\""),
        InWorld("TextureOfALaterOne",
                "Texture \"a\" \"float\" \"scale\"\n\"texture tex\" \"b\"\n"
                "Texture \"b\" \"float\" \"constant\"",
                3, "before it is part of another"),
        InWorld("LaterTextureOfOtherKind",
                "Material \"diffuse\" \"texture reflectance\" \"t\"\n"
                "Texture \"t\" \"float\" \"constant\"",
                2, "is no spectrum texture"),
        InWorld("FloatForSpectrum",
                "Texture \"t\" \"float\" \"constant\"\n"
                "Material \"diffuse\" \"texture reflectance\" \"t\"",
                3, "no spectrum texture"),
        InWorld("ImageWithoutFile", "Texture \"t\" \"float\" \"imagemap\"", 2, "filename"),
        InWorld("MissingImage",
                "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"no.png\"\n"
                "Material \"conductor\" \"texture roughness\" \"t\" Shape \"sphere\"",
                2, "no.png"),
        InWorld("BadEncoding",
                "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"scene.pbrt\" \"string "
                "encoding\" \"gamma x\"",
                2, "encoding"),
        InWorld("UnknownImageFilter",
                "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"scene.pbrt\" \"string "
                "filter\" \"sharp\"",
                2, "unknown image filter \"sharp\""),
        InWorld("Hair", "Material \"hair\"", 2, "material \"hair\" is not supported"),
        InWorld("Measured", "Material \"measured\"", 2, "is not supported"),
        InWorld("Subsurface", "Material \"subsurface\"", 2, "is not supported"),
        InWorld("ReflectanceAboveOne", "Material \"diffuse\" \"rgb reflectance\" [ 1 1 1.5 ]", 2,
                "within [0, 1]"),
        InWorld("NegativeColor", "Material \"conductor\" \"rgb k\" [ 1 -1 1 ]", 2, "not negative"),
        InWorld("FloatAsColor", "Material \"diffuse\" \"float reflectance\" 0.5", 2, "type rgb"),
        InWorld("ReflectanceAndEta",
                "Material \"conductor\" \"rgb reflectance\" [ 1 1 1 ] \"rgb eta\" [ 1 1 1 ]", 2,
                "excludes"),
        InWorld("ZeroEta", "Material \"dielectric\" \"float eta\" 0", 2, "more than 0"),
        InWorld("NegativeRoughness", "Material \"dielectric\" \"float roughness\" -1", 2,
                "negative"),
        InWorld("UndefinedMaterial", "\nNamedMaterial \"m\"", 3, "\"m\" is not defined"),
        InWorld("MaterialWithoutType", "MakeNamedMaterial \"m\"", 2, "string type"),
        InWorld("MixOfOne", "Material \"mix\" \"string materials\" \"a\"", 2, "two names"),
        InWorld("MixOfItself",
                "MakeNamedMaterial \"m\" \"string type\" \"mix\" \"string materials\" [ \"m\" "
                "\"m\" ]",
                2, "contain themselves")),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    Spectra, MistakeTest,
    testing::Values(
        InWorld("UnknownSpectrum", "Material \"conductor\" \"spectrum eta\" \"metal-Unobtainium\"",
                2, "no named spectrum"),
        InWorld("OddSpectrum", "Material \"diffuse\" \"spectrum reflectance\" [ 400 1 500 ]", 2,
                "pairs"),
        InWorld("UnsortedSpectrum", "Material \"diffuse\" \"spectrum reflectance\" [ 500 1 400 1 ]",
                2, "do not increase"),
        InWorld("EmptySpectrum", "Material \"diffuse\" \"spectrum reflectance\" [ ]", 2,
                "no samples"),
        InWorld("SpectrumAboveOne", "Material \"diffuse\" \"spectrum reflectance\" [ 400 2 500 1 ]",
                2, "within [0, 1]"),
        InWorld("ColdBody", "LightSource \"infinite\" \"blackbody L\" 0", 2, "one temperature"),
        InWorld("FourColors", "Material \"diffuse\" \"rgb reflectance\" [ 1 1 1 1 1 1 ]", 2,
                "three numbers")),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    LightsAndShapes, MistakeTest,
    testing::Values(
        InWorld("OtherLight", "LightSource \"laser\"", 2, "is not supported"),
        InWorld("WideSpot", "LightSource \"spot\" \"float coneangle\" 181", 2, "at most 180"),
        InWorld("SpotOfNoWidth", "LightSource \"spot\" \"float coneangle\" 0", 2, "more than 0"),
        InWorld("SpotThatGrows", "LightSource \"spot\" \"float conedeltaangle\" -1", 2, "negative"),
        InWorld("SpotWithoutDirection",
                "LightSource \"spot\" \"point3 from\" [ 1 1 1 ] \"point3 to\" [ 1 1 1 ]", 2,
                "no direction"),
        InWorld("NegativeSpot", "LightSource \"spot\" \"float scale\" -1", 2, "negative"),
        InWorld("ProjectionOfNothing", "LightSource \"projection\"", 2, "filename"),
        InWorld("ProjectionOfNoFile", "LightSource \"projection\" \"string filename\" \"no.png\"",
                2, "no.png"),
        InWorld("WideProjection",
                "LightSource \"projection\" \"string filename\" \"scene.pbrt\" \"float fov\" 180",
                2, "less than 180"),
        InWorld("DiagramOfNothing", "LightSource \"goniometric\"", 2, "filename"),
        InWorld("DiagramOfNoFile", "LightSource \"goniometric\" \"string filename\" \"no.ies\"", 2,
                "no.ies"),
        InWorld("FlatDiagram",
                "Scale 1 0 1 LightSource \"goniometric\" \"string filename\" \"scene.pbrt\"", 2,
                "inverted"),
        InWorld("OtherAreaLight", "AreaLightSource \"laser\"", 2, "is not supported"),
        InWorld("ImageAndColorOfAreaLight",
                "AreaLightSource \"diffuse\" \"string filename\" \"a.png\" \"rgb L\" [ 1 1 1 ]", 2,
                "not both"),
        InWorld("MissingImageOfAreaLight",
                "AreaLightSource \"diffuse\" \"string filename\" \"a.png\"\nShape \"sphere\"", 2,
                "a.png"),
        InWorld("PowerOfNoImage",
                "AreaLightSource \"diffuse\" \"string filename\" \"scene.pbrt\" \"float power\" 1",
                2, "scene.pbrt"),
        InWorld("NegativePoint", "LightSource \"point\" \"float scale\" -1", 2, "negative"),
        InWorld("NegativeSun", "LightSource \"distant\" \"float scale\" -1", 2, "negative"),
        InWorld("NegativeSky", "LightSource \"infinite\" \"float scale\" -1", 2, "negative"),
        InWorld("NegativeImageSky",
                "LightSource \"infinite\" \"string filename\" \"scene.pbrt\" \"float scale\" -1", 2,
                "negative"),
        InWorld("NegativeAreaLight", "AreaLightSource \"diffuse\" \"float scale\" -1", 2,
                "negative"),
        InWorld("NegativeIntensity", "LightSource \"point\" \"rgb I\" [ 1 -1 1 ]", 2,
                "not negative"),
        InWorld("BlindingPoint", "LightSource \"point\" \"rgb I\" [ 1 1e30 1 ] \"float scale\" 1e9",
                2, "too bright"),
        InWorld("BlindingSun",
                "LightSource \"distant\" \"float scale\" 1e30 \"float illuminance\" 1e30", 2,
                "too bright"),
        InWorld("BlindingSky",
                "LightSource \"infinite\" \"rgb L\" [ 1 1e30 1 ] \"float scale\" 1e9", 2,
                "too bright"),
        InWorld("BlindingAreaLight",
                "AreaLightSource \"diffuse\" \"rgb L\" [ 1 1e30 1 ] \"float scale\" 1e9", 2,
                "too bright"),
        InWorld("NoDirection", "LightSource \"distant\" \"point3 to\" [ 0 0 0 ]", 2,
                "no direction"),
        InWorld("ImageAndColor",
                "LightSource \"infinite\" \"string filename\" \"a.pfm\" \"rgb L\" [ 1 1 1 ]", 2,
                "not both"),
        InWorld("PortalOfThreeCorners",
                "LightSource \"infinite\" \"string filename\" \"scene.pbrt\" \"point3 portal\" "
                "[ 0 0 0 1 0 0 0 1 0 ]",
                2, "3 corners"),
        InWorld("MissingSky", "LightSource \"infinite\" \"string filename\" \"sky.pfm\"", 2,
                "sky.pfm"),
        InWorld("Subdivision", "Shape \"loopsubdiv\"", 2, "integer indices"),
        InWorld("Curve", "Shape \"curve\"", 2, "control points"),
        InWorld("OtherShape", "Shape \"teapot\"", 2, "unknown Shape"),
        InWorld("ZeroSphere", "Shape \"sphere\" \"float radius\" 0", 2, "more than 0"),
        InWorld("NegativeDisk", "Shape \"disk\" \"float radius\" -1", 2, "more than 0"),
        InWorld("DiskWithoutArea", "Shape \"disk\" \"float innerradius\" 1", 2, "innerradius"),
        InWorld("FlatCylinder", "Shape \"cylinder\" \"float zmin\" 1", 2, "equal"),
        InWorld("NoPositions", "Shape \"trianglemesh\" \"integer indices\" [ 0 1 2 ]", 2,
                "\"point3 P\""),
        InWorld("NoIndices", "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 ]", 2, "indices"),
        InWorld("OddIndices",
                "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" "
                "[ 0 1 2 0 ]",
                2, "no multiple of 3"),
        InWorld("IndexTooLarge",
                "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" "
                "[ 0 1 3 ]",
                2, "vertex index 3"),
        InWorld("IndexNegative",
                "Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 1 1 0 ] \"integer "
                "indices\" [ 0 1 2 -1 ]",
                2, "vertex index -1"),
        InWorld("FewNormals",
                "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"normal N\" [ 0 0 1 ]",
                2, "\"N\""),
        InWorld("FewUvs",
                "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"point2 uv\" [ 0 0 ]",
                2, "\"uv\""),
        InWorld("PlyWithoutFile", "Shape \"plymesh\"", 2, "filename"),
        InWorld("MissingPly", "Shape \"plymesh\" \"string filename\" \"no.ply\"", 2, "no.ply"),
        InWorld("PowerOfSkewedSphere",
                "Scale 1 2 1 AreaLightSource \"diffuse\" \"float power\" 1\nShape \"sphere\"", 3,
                "power")),
    NameOf);

}  // namespace
}  // namespace strata
