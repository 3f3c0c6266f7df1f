#include "tests/cli/scene_folder.h"

#include <fstream>
#include <sstream>

namespace strata::test {
namespace {

/// A floor and a sphere under a square lamp.
std::string SceneText(int spp) {
  return R"(LookAt 0 1.5 -4  0 0.6 0  0 1 0
Camera "perspective" "float fov" [40]
Film "rgb" "integer xresolution" [24] "integer yresolution" [16]
Sampler "independent" "integer pixelsamples" [)" +
         std::to_string(spp) + R"(]
Integrator "path" "integer maxdepth" [4]
PixelFilter "box"
WorldBegin
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [8 7 6]
  Shape "trianglemesh" "point3 P" [-1 3 -1  1 3 -1  1 3 1  -1 3 1]
    "integer indices" [0 1 2 0 2 3]
AttributeEnd
Material "diffuse" "rgb reflectance" [0.6 0.5 0.4]
Shape "trianglemesh" "point3 P" [-3 0 -3  3 0 -3  3 0 3  -3 0 3]
  "integer indices" [0 2 1 0 3 2]
Material "conductor" "float roughness" [0.2]
Translate 0 0.6 0
Shape "sphere" "float radius" [0.6]
)";
}

}  // namespace

SceneFolder::SceneFolder() : directory_(*TemporaryDirectory::Create()) {}

std::string SceneFolder::Write(const std::string& name, const std::string& content) const {
  std::filesystem::create_directories((directory_.path() / name).parent_path());
  std::ofstream(directory_.path() / name, std::ios::binary) << content;
  return Path(name);
}

std::string SceneFolder::TinyScene() const { return Write("tiny.pbrt", SceneText(16)); }
std::string SceneFolder::LongScene() const { return Write("long.pbrt", SceneText(8000000)); }

std::string ReadFile(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace strata::test
