#include <bit>
#include <span>

#include "worker/integrator/render.h"
#include "worker/light/environment.h"
#include "worker/sampling/sampler.h"
#include "worker/scene/scene.h"

// The digest by which two workers know that they compute the same bits: a scene of one of each,
// rendered by each kernel with each sampler.

namespace strata {
namespace {

/// Builds the scene of the traced digest.
class DigestScene {
 public:
  SceneDescription Build() && {
    AddMaterials();
    AddShapes();
    AddLights();
    AddCamera();
    return std::move(scene_);
  }

 private:
  static constexpr MaterialId kInterface = 11;  ///< The last.

  TextureId Texture(TextureDescription texture) {
    scene_.textures.push_back(std::move(texture));
    return static_cast<TextureId>(scene_.textures.size()) - 1;
  }
  TextureId Gray(float value) { return Texture(ConstantTexture{Rgb::Gray(value)}); }

  void AddMaterials() {
    const TextureId checks = Texture(CheckerboardTexture{
        .a = Texture(ConstantTexture{{0.7f, 0.5f, 0.3f}}), .b = Gray(0.2f), .mapping = {4, 4}});
    const TextureId blend = Texture(MixTexture{.a = checks, .b = Gray(0.9f), .amount = Gray(0.3f)});
    const Roughness rough = {.u = Gray(0.1f), .v = Gray(0.3f)};
    const TextureId eta = Texture(ConstantTexture{{0.2f, 0.9f, 1.1f}});
    const TextureId k = Texture(ConstantTexture{{3.9f, 2.5f, 2.1f}});
    const TextureId half = Gray(0.5f);
    scene_.materials = {
        DiffuseMaterial{checks},
        DiffuseMaterial{blend},
        ConductorMaterial{.eta = eta, .k = k, .roughness = rough},
        ConductorMaterial{.reflectance = half},
        DielectricMaterial{.eta = 1.5f},
        DielectricMaterial{.eta = 1.3f, .roughness = rough},
        ThinDielectricMaterial{},
        CoatedDiffuseMaterial{.reflectance = checks, .roughness = rough, .albedo = Gray(0)},
        CoatedConductorMaterial{.interface_roughness = rough, .eta = eta, .k = k},
        DiffuseTransmissionMaterial{.reflectance = half, .transmittance = Gray(0.3f)},
        MixMaterial{.a = 2, .b = 1, .amount = half},
        InterfaceMaterial{},
    };
    const SourceLocation where = {"traced digest", 1};
    scene_.media = {
        {.where = where, .absorption = {0.01f, 0.01f, 0.02f}, .scattering = {0.03f, 0.02f, 0.02f}},
        {.where = where, .absorption = {0.1f, 0.5f, 1}},
        {.where = where,
         .absorption = {0.5f, 0.4f, 0.3f},
         .scattering = {2, 3, 4},
         .emission = {0.3f, 0.1f, 0},
         .g = 0.4f},
    };
  }

  ShapeDescription Shape(ShapeGeometry geometry, int material, Vec3f at) const {
    ShapeDescription shape;
    shape.where = {"traced digest", 1};
    shape.geometry = std::move(geometry);
    shape.to_world = Transform::Translate(at.x, at.y, at.z);
    shape.material = material;
    return shape;
  }

  void AddShapes() {
    const TriangleMeshShape floor = {
        .positions = {{-5, -1, -5}, {5, -1, -5}, {5, -1, 5}, {-5, -1, 5}},
        .uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}},
        .triangles = {{0, 2, 1}, {0, 3, 2}},
    };
    const BilinearPatchShape patch = {
        .positions = {{-4, -1, 4}, {4, -1, 4}, {-4, 3, 4.5f}, {4, 3, 3.5f}},
        .patches = {{0, 1, 2, 3}},
    };
    // Shows the lamps to points of the floor: see MirrorGuide.
    const TriangleMeshShape mirror = {
        .positions = {{4.9f, -1, -3}, {4.9f, 4, -3}, {4.9f, 4, 5}, {4.9f, -1, 5}},
        .triangles = {{0, 2, 1}, {0, 3, 2}},
    };
    auto& shapes = scene_.shapes;
    shapes.push_back(Shape(floor, 0, {0, 0, 0}));
    shapes.push_back(Shape(mirror, 2, {0, 0, 0}));
    shapes.push_back(Shape(patch, 1, {0, 0, 0}));
    // A grid of spheres, one for each of the other materials.
    for (int material = 2; material < kInterface; ++material) {
      const int i = material - 2;
      shapes.push_back(Shape(SphereShape{.radius = 0.5f, .z_min = -0.5f, .z_max = 0.5f}, material,
                             {-1.6f + 1.6f * (i % 3), -0.5f + 1.1f * (i / 3), 1.0f}));
    }
    // Glass with a medium in it, and a border that is nothing else.
    for (ShapeDescription& shape : shapes)
      if (shape.material == 4) shape.border = MediumBorder{1, 0};
    shapes.push_back(Shape(SphereShape{.radius = 0.5f, .z_min = -0.5f, .z_max = 0.5f}, kInterface,
                           {1.4f, -0.4f, -0.6f}));
    shapes.back().border = MediumBorder{2, 0};
    shapes.push_back(Shape(CylinderShape{.radius = 0.3f}, 2, {-2.8f, 0, 0.5f}));
    ObjectDescription& object = scene_.objects.emplace_back();
    object.shapes.push_back(Shape(DiskShape{.radius = 0.6f}, 7, {0, 0, 0}));
    InstanceDescription& instance = scene_.instances.emplace_back();
    instance.to_world = Transform::Translate(2.8, 0, 1) * Transform::Rotate(35, 0, 1, 0);

    ShapeDescription lamp =
        Shape(SphereShape{.radius = 0.3f, .z_min = -0.3f, .z_max = 0.3f}, 0, {2, 2.5f, -1});
    lamp.emission = AreaEmission{{6, 5, 4}};
    shapes.push_back(lamp);
    ShapeDescription disk = Shape(DiskShape{.radius = 0.5f}, 0, {-2, 2, 2});
    disk.emission = AreaEmission{{3, 4, 5}, true};
    shapes.push_back(disk);
    const TriangleMeshShape panel = {.positions = {{-1, 3, -1}, {1, 3, -1}, {0, 3, 1}},
                                     .triangles = {{0, 1, 2}}};
    ShapeDescription triangle = Shape(panel, 0, {0, 0, 0});
    triangle.emission = AreaEmission{{8, 8, 8}, true};
    shapes.push_back(triangle);
    // Near to some points and far from others.
    const TriangleMeshShape screen = {
        .positions = {{-3, -0.9f, 3}, {-1, -0.9f, 3}, {-1, 0.3f, 3}, {-3, 0.3f, 3}},
        .triangles = {{0, 2, 1}, {0, 3, 2}}};
    ShapeDescription rectangle = Shape(screen, 0, {0, 0, 0});
    rectangle.emission = AreaEmission{{2, 1, 1}};
    shapes.push_back(rectangle);
  }

  void AddLights() {
    const SourceLocation where = {"traced digest", 1};
    scene_.lights = {
        {where, PointLightDescription{{-2, 2, -2}, {2, 2, 2}}},
        {where, DistantLightDescription{{0, 0.8f, -0.6f}, {0.5f, 0.5f, 0.4f}}},
        {where, ConstantInfiniteLightDescription{{0.3f, 0.4f, 0.5f}}},
    };
  }

  void AddCamera() {
    scene_.camera.camera_to_world =
        *Transform::LookAt({0, 0.8, -6}, {0, 0.4, 1}, {0, 1, 0})->Inverse();
    scene_.camera.fov = 50;
    scene_.camera.lens_radius = 0.05f;
    scene_.camera.medium = 0;
    scene_.camera.focal_distance = 6.5f;
  }

  SceneDescription scene_;
};

void Add(Sha256& sha, double value) {
  const uint64_t bits = std::bit_cast<uint64_t>(value);
  sha.Update(std::as_bytes(std::span(&bits, 1)));
}

/// Image environments come from files, which this scene has none of: their kernels are called here.
void AddEnvironment(Sha256& sha, EnvironmentMapping mapping) {
  constexpr int kSize = 8;
  std::vector<Rgb> pixels;
  for (int i = 0; i < kSize * kSize; ++i)
    pixels.push_back(Rgb{1, 2, 3} * static_cast<float>(i * 7 % 11));
  const EnvironmentImage image(kSize, kSize, pixels, mapping, Frame::FromNormal({0.6f, 0, 0.8f}),
                               true);
  const ImageEnvironment light = {&image};
  SobolSampler sampler({});
  for (uint32_t index = 0; index < 64; ++index) {
    sampler.StartSample(index);
    const auto sample = SampleLi(light, {}, sampler.Get2D(kPairLight));
    if (!sample) continue;
    for (float value : {sample->wi.x, sample->wi.y, sample->wi.z, sample->radiance.g, sample->pdf,
                        PdfLi(light, sample->wi)})
      Add(sha, value);
  }
}

void AddRender(Sha256& sha, const std::shared_ptr<const Scene>& scene, KernelKind kernel,
               SamplerKind sampler, FilterKind filter) {
  constexpr int kSize = 24;
  JobSpec spec;
  spec.bundle.scene = "traced-digest";
  spec.bundle.files = {{spec.bundle.scene, {}, 0}};
  spec.width = spec.height = kSize;
  spec.crop = {0, 0, kSize, kSize};
  spec.max_depth = 8;
  spec.kernel = kernel;
  spec.sampler = sampler;
  spec.filter = DefaultFilter(filter);
  spec.channels = {.alpha = true, .albedo = true, .normal = true, .depth = true};
  const auto renderer = Renderer::Create(scene, spec);
  RenderPool pool(1);
  const auto partial = renderer.ok() ? (*renderer)->Render({{}, spec.crop, {{0, 1}}}, pool)
                                     : absl::StatusOr<Partial>(renderer.status());
  if (!partial.ok()) {
    // Equal refusals still compare equal; a worker that alone refuses still differs.
    sha.Update(partial.status().ToString());
    return;
  }
  for (double value : partial->values) Add(sha, value);
  for (uint64_t rays : partial->rays) Add(sha, static_cast<double>(rays));
}

}  // namespace

Digest TracedDigest() {
  Sha256 sha;
  const auto scene = Scene::Build(DigestScene().Build(), DirectorySource("."));
  if (scene.ok()) {
    for (const KernelKind kernel : {KernelKind::kFast, KernelKind::kReference}) {
      AddRender(sha, *scene, kernel, SamplerKind::kSobol, FilterKind::kMitchell);
      AddRender(sha, *scene, kernel, SamplerKind::kIndependent, FilterKind::kGaussian);
    }
  } else {
    sha.Update(scene.status().ToString());
  }
  AddEnvironment(sha, EnvironmentMapping::kEqualArea);
  AddEnvironment(sha, EnvironmentMapping::kLatLong);
  return sha.Finish();
}

}  // namespace strata
