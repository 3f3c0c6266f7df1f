#include "worker/bsdf/material.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/statistics/chi_square.h"
#include "tests/statistics/random.h"

namespace strata {
namespace {

/// The scenes here have no files.
class NoFiles : public FileSource {
 public:
  absl::StatusOr<std::filesystem::path> Locate(const std::string& path) const override {
    return absl::NotFoundError(path);
  }
};

/// Textures and the materials made of them.
class Materials {
 public:
  TextureId Constant(Rgb value) { return Add(ConstantTexture{value}); }
  TextureId Number(float value) { return Constant(Rgb::Gray(value)); }
  /// `a` where the cell of (u, v) is even, else `b`.
  TextureId Checkerboard(TextureId a, TextureId b) { return Add(CheckerboardTexture{a, b}); }

  MaterialId Add(MaterialDescription material) {
    materials_.push_back(std::move(material));
    return static_cast<MaterialId>(materials_.size()) - 1;
  }
  absl::Status Build() {
    auto textures = TextureSet::Load(textures_, NoFiles());
    if (!textures.ok()) return textures.status();
    texture_set_ = *std::move(textures);
    auto set = MaterialSet::Build(materials_, *texture_set_);
    if (!set.ok()) return set.status();
    set_ = *std::move(set);
    return absl::OkStatus();
  }
  Bsdf Evaluate(MaterialId id, Vec2f uv = {0.5f, 0.5f}, float u_mix = 0.5f) const {
    return set_->Evaluate(id, uv, {}, u_mix, &room_);
  }

 private:
  TextureId Add(TextureDescription texture) {
    textures_.push_back(std::move(texture));
    return static_cast<TextureId>(textures_.size()) - 1;
  }

  std::vector<TextureDescription> textures_;
  std::vector<MaterialDescription> materials_;
  std::unique_ptr<TextureSet> texture_set_;
  std::unique_ptr<MaterialSet> set_;
  mutable BsdfRoom room_;
};

TEST(MaterialSet, EveryKindBecomesItsBsdf) {
  Materials m;
  const TextureId half = m.Number(0.5f), quarter = m.Number(0.25f);
  const Roughness rough = {.u = quarter, .v = half};
  const MaterialId diffuse = m.Add(DiffuseMaterial{m.Constant({0.1f, 0.2f, 2})});
  const MaterialId metal = m.Add(ConductorMaterial{.eta = half, .k = half, .roughness = rough});
  const MaterialId glass =
      m.Add(DielectricMaterial{1.3f, {.u = quarter, .v = half, .remap = false}});
  const MaterialId pane = m.Add(ThinDielectricMaterial{1.4f});
  const MaterialId plastic = m.Add(CoatedDiffuseMaterial{.reflectance = half});
  const MaterialId car = m.Add(CoatedConductorMaterial{.reflectance = half});
  const MaterialId leaf = m.Add(DiffuseTransmissionMaterial{half, quarter, 0.5f});
  const MaterialId nothing = m.Add(InterfaceMaterial{});
  ASSERT_TRUE(m.Build().ok());

  // Reflectance above 1 is cut.
  EXPECT_EQ(std::get<DiffuseBsdf>(m.Evaluate(diffuse)).reflectance, (Rgb{0.1f, 0.2f, 1}));
  EXPECT_FLOAT_EQ(std::get<ConductorBsdf>(m.Evaluate(metal)).ggx.alpha_x, 0.5f);
  EXPECT_FLOAT_EQ(std::get<ConductorBsdf>(m.Evaluate(metal)).ggx.alpha_y, std::sqrt(0.5f));
  EXPECT_FLOAT_EQ(std::get<DielectricBsdf>(m.Evaluate(glass)).ggx.alpha_x, 0.25f);
  EXPECT_FLOAT_EQ(std::get<DielectricBsdf>(m.Evaluate(glass)).eta, 1.3f);
  EXPECT_FLOAT_EQ(std::get<ThinDielectricBsdf>(m.Evaluate(pane)).eta, 1.4f);
  EXPECT_TRUE(std::get<CoatedDiffuseBsdf>(m.Evaluate(plastic)).coat.IsSmooth());
  EXPECT_TRUE(IsDelta(m.Evaluate(car)));
  EXPECT_EQ(std::get<DiffuseTransmissionBsdf>(m.Evaluate(leaf)).transmittance, Rgb::Gray(0.125f));
  // An interface lets everything pass.
  const std::optional<BsdfSample> s = Sample(m.Evaluate(nothing), {0.6f, 0, 0.8f}, 0, {});
  ASSERT_TRUE(s && s->transmission);
  EXPECT_EQ(s->wi, (Vec3f{-0.6f, 0, -0.8f}));
  EXPECT_EQ(s->weight, Rgb::Gray(1));
}

TEST(MaterialSet, ReflectanceOfAMetalIsMetAtNormalIncidence) {
  Materials m;
  const MaterialId metal = m.Add(ConductorMaterial{.reflectance = m.Constant({0.2f, 0.5f, 0.9f})});
  ASSERT_TRUE(m.Build().ok());
  const Rgb albedo = Albedo(m.Evaluate(metal), {0, 0, 1});
  EXPECT_NEAR(albedo.r, 0.2f, 1e-5);
  EXPECT_NEAR(albedo.g, 0.5f, 1e-5);
  EXPECT_NEAR(albedo.b, 0.9f, 1e-5);
}

TEST(MaterialSet, TexturesAreLookedUpAtThePoint) {
  Materials m;
  const TextureId black = m.Number(0), white = m.Number(1);
  const MaterialId board = m.Add(DiffuseMaterial{m.Checkerboard(black, white)});
  ASSERT_TRUE(m.Build().ok());
  const float at = std::get<DiffuseBsdf>(m.Evaluate(board, {0.5f, 0.5f})).reflectance.r;
  const float beside = std::get<DiffuseBsdf>(m.Evaluate(board, {1.5f, 0.5f})).reflectance.r;
  EXPECT_EQ(at + beside, 1);
  EXPECT_NE(at, beside);
}

TEST(MaterialSet, MixesChooseByTheirAmounts) {
  Materials m;
  const MaterialId a = m.Add(DiffuseMaterial{m.Number(0.1f)});
  const MaterialId b = m.Add(DiffuseMaterial{m.Number(0.2f)});
  const MaterialId c = m.Add(DiffuseMaterial{m.Number(0.3f)});
  const MaterialId inner = m.Add(MixMaterial{a, b, m.Number(0.25f)});
  const MaterialId outer = m.Add(MixMaterial{inner, c, m.Number(0.4f)});
  const MaterialId first = m.Add(MixMaterial{a, b, m.Number(0)});
  const MaterialId second = m.Add(MixMaterial{a, b, m.Number(1)});
  ASSERT_TRUE(m.Build().ok());
  TestRandom random(1);
  std::vector<double> counts(3, 0.0);
  constexpr int kSamples = 100000;
  for (int i = 0; i < kSamples; ++i) {
    const Bsdf bsdf = m.Evaluate(outer, {}, random.Float());
    ++counts[std::lround(std::get<DiffuseBsdf>(bsdf).reflectance.r * 10) - 1];
  }
  const std::vector<double> expected = {0.6 * 0.75 * kSamples, 0.6 * 0.25 * kSamples,
                                        0.4 * kSamples};
  EXPECT_GT(ChiSquareTest(counts, expected).p, 0.01);
  for (const float u : {0.0f, 1 - 0x1p-24f}) {
    EXPECT_FLOAT_EQ(std::get<DiffuseBsdf>(m.Evaluate(first, {}, u)).reflectance.r, 0.1f);
    EXPECT_FLOAT_EQ(std::get<DiffuseBsdf>(m.Evaluate(second, {}, u)).reflectance.r, 0.2f);
  }
}

TEST(MaterialSet, SumsHaveAllTheirParts) {
  Materials m;
  const MaterialId a = m.Add(DiffuseMaterial{m.Number(0.1f)});
  const MaterialId b = m.Add(BlinnMaterial{.eta = m.Number(1.5f), .exponent = m.Number(7)});
  const MaterialId c =
      m.Add(AshikhminShirleyMaterial{m.Number(0.3f), m.Number(0.2f), m.Number(5), m.Number(9)});
  const MaterialId inner = m.Add(MixMaterial{a, b, m.Number(0.25f), true});
  const MaterialId outer = m.Add(MixMaterial{inner, c, m.Number(0.4f), true});
  const MaterialId only = m.Add(MixMaterial{a, c, m.Number(1), true});
  const MaterialId chosen = m.Add(MixMaterial{inner, c, m.Number(0.5f)});
  ASSERT_TRUE(m.Build().ok());
  const Bsdf sum = m.Evaluate(outer);
  const MixtureParts& parts = *std::get<MixtureBsdf>(sum).parts;
  ASSERT_EQ(parts.count, 3);
  EXPECT_FLOAT_EQ(parts.weights[0], 0.6f * 0.75f);
  EXPECT_FLOAT_EQ(parts.weights[1], 0.6f * 0.25f);
  EXPECT_FLOAT_EQ(parts.weights[2], 0.4f);
  EXPECT_FLOAT_EQ(std::get<DiffuseBsdf>(parts.bsdfs[0]).reflectance.r, 0.1f);
  EXPECT_FLOAT_EQ(std::get<BlinnBsdf>(parts.bsdfs[1]).exponent, 7);
  EXPECT_FLOAT_EQ(std::get<AshikhminShirleyBsdf>(parts.bsdfs[2]).normals.nv, 9);
  EXPECT_FLOAT_EQ(std::get<AshikhminShirleyBsdf>(m.Evaluate(only)).specular.g, 0.2f);
  EXPECT_TRUE(std::holds_alternative<AshikhminShirleyBsdf>(m.Evaluate(chosen, {}, 0.2f)));
  EXPECT_EQ(std::get<MixtureBsdf>(m.Evaluate(chosen, {}, 0.7f)).parts->count, 2);
}

TEST(MaterialSet, SumsOfTooManyPartsAreRefused) {
  Materials m;
  MaterialId sum = m.Add(DiffuseMaterial{m.Number(0.1f)});
  for (int i = 0; i < 2; ++i) sum = m.Add(MixMaterial{sum, sum, m.Number(0.5f), true});
  ASSERT_TRUE(m.Build().ok());
  m.Add(MixMaterial{sum, 0, m.Number(0.5f), true});
  const absl::Status status = m.Build();
  EXPECT_NE(status.message().find("material 3: the sum has more than 4 parts"), std::string::npos)
      << status;
}

void ExpectRefused(MaterialDescription material, const std::string& word) {
  Materials m;
  m.Add(std::move(material));
  const absl::Status status = m.Build();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_NE(std::string(status.message()).find("material 0: "), std::string::npos) << status;
  EXPECT_NE(std::string(status.message()).find(word), std::string::npos) << status;
}

TEST(MaterialSet, BadParametersAreRefusedWithTheReason) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  ExpectRefused(DielectricMaterial{.eta = 0}, "index of refraction");
  ExpectRefused(DielectricMaterial{.eta = nan}, "index of refraction");
  ExpectRefused(ThinDielectricMaterial{.eta = -1}, "index of refraction");
  ExpectRefused(CoatedDiffuseMaterial{.eta = 0.9f}, "index of a coat");
  ExpectRefused(CoatedDiffuseMaterial{.thickness = -1}, "thickness");
  ExpectRefused(CoatedConductorMaterial{.interface_eta = nan}, "index of a coat");
  ExpectRefused(DiffuseTransmissionMaterial{.scale = -1}, "scale");
  ExpectRefused(MixMaterial{0, 5, kNoTexture}, "does not exist");
  ExpectRefused(MixMaterial{0, 0, kNoTexture}, "contains itself");
}

TEST(MaterialSet, LongerCyclesAreFoundAndSharedMaterialsAreNone) {
  Materials cycle;
  cycle.Add(MixMaterial{1, 3, kNoTexture});
  cycle.Add(MixMaterial{3, 2, kNoTexture});
  cycle.Add(MixMaterial{0, 3, kNoTexture});
  cycle.Add(DiffuseMaterial{});
  EXPECT_FALSE(cycle.Build().ok());
  Materials shared;
  shared.Add(MixMaterial{1, 2, kNoTexture});
  shared.Add(MixMaterial{3, 3, kNoTexture});
  shared.Add(MixMaterial{1, 3, kNoTexture});
  shared.Add(DiffuseMaterial{});
  EXPECT_TRUE(shared.Build().ok());
}

}  // namespace
}  // namespace strata
