#include "worker/geometry/noise.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "worker/math/elementary.h"

namespace strata {
namespace {

/// Each of 0 to 255 once (Perlin 2002).
constexpr std::array<uint8_t, 256> kPermutation = {
    151, 160, 137, 91,  90,  15,  131, 13,  201, 95,  96,  53,  194, 233, 7,   225, 140, 36,  103,
    30,  69,  142, 8,   99,  37,  240, 21,  10,  23,  190, 6,   148, 247, 120, 234, 75,  0,   26,
    197, 62,  94,  252, 219, 203, 117, 35,  11,  32,  57,  177, 33,  88,  237, 149, 56,  87,  174,
    20,  125, 136, 171, 168, 68,  175, 74,  165, 71,  134, 139, 48,  27,  166, 77,  146, 158, 231,
    83,  111, 229, 122, 60,  211, 133, 230, 220, 105, 92,  41,  55,  46,  245, 40,  244, 102, 143,
    54,  65,  25,  63,  161, 1,   216, 80,  73,  209, 76,  132, 187, 208, 89,  18,  169, 200, 196,
    135, 130, 116, 188, 159, 86,  164, 100, 109, 198, 173, 186, 3,   64,  52,  217, 226, 250, 124,
    123, 5,   202, 38,  147, 118, 126, 255, 82,  85,  212, 207, 206, 59,  227, 47,  16,  58,  17,
    182, 189, 28,  42,  223, 183, 170, 213, 119, 248, 152, 2,   44,  154, 163, 70,  221, 153, 101,
    155, 167, 43,  172, 9,   129, 22,  39,  253, 19,  98,  108, 110, 79,  113, 224, 232, 178, 185,
    112, 104, 218, 246, 97,  228, 251, 34,  242, 193, 238, 210, 144, 12,  191, 179, 162, 241, 81,
    51,  145, 235, 249, 14,  239, 107, 49,  192, 214, 31,  181, 199, 106, 157, 184, 84,  204, 176,
    115, 121, 50,  45,  127, 4,   150, 254, 138, 236, 205, 93,  222, 114, 67,  29,  24,  72,  243,
    141, 128, 195, 78,  66,  215, 61,  156, 180};

/// A lattice cell, and where in it a coordinate lies.
struct Cell {
  uint8_t index;
  double fraction;
};
Cell CellOf(double x) {
  const double low = std::floor(x);
  return {static_cast<uint8_t>(low - 256 * std::floor(low / 256)), x - low};
}

/// The gradient of a lattice point times the way from there.
double Gradient(int x, int y, int z, double dx, double dy, double dz) {
  const auto permuted = [](int i) { return kPermutation[static_cast<size_t>(i & 255)]; };
  const int h = permuted(permuted(permuted(x) + y) + z) & 15;
  const double u = h < 8 || h == 12 || h == 13 ? dx : dy;
  const double v = h < 4 || h == 12 || h == 13 ? dy : dz;
  return (h & 1 ? -u : u) + (h & 2 ? -v : v);
}

double Fade(double t) { return t * t * t * (t * (6 * t - 15) + 10); }
double Mix(double t, double a, double b) { return (1 - t) * a + t * b; }

/// The cubic Bezier curve of four points.
Rgb Bezier(const Rgb* points, float t) {
  const float s = 1 - t;
  return points[0] * (s * s * s) + points[1] * (3 * s * s * t) + points[2] * (3 * s * t * t) +
         points[3] * (t * t * t);
}

/// pbrt's veins.
Rgb Marble(double where) {
  constexpr Rgb kPale = {0.58f, 0.58f, 0.6f};
  constexpr std::array<Rgb, 9> kColors = {kPale,
                                          kPale,
                                          kPale,
                                          {0.5f, 0.5f, 0.5f},
                                          {0.6f, 0.59f, 0.58f},
                                          kPale,
                                          kPale,
                                          {0.2f, 0.2f, 0.33f},
                                          kPale};
  constexpr int kPieces = static_cast<int>(kColors.size()) - 3;
  // So far out a turn is finer than a float can place a point, or there is no number at all.
  constexpr double kFarthest = 1e9;
  const double t = std::fabs(where) < kFarthest ? 0.5 + 0.5 * Sin(where) : 0.5;
  const int first = std::clamp(static_cast<int>(std::floor(t * kPieces)), 0, kPieces - 1);
  return Bezier(&kColors[static_cast<size_t>(first)], static_cast<float>(t * kPieces - first)) *
         1.5f;
}

/// Not 2, so that zeros of octaves do not coincide.
constexpr double kLacunarity = 1.99;

/// The sum of f(noise) over octaves, and the weight that the next one would have.
template <typename F>
double SumOctaves(Vec3d p, double roughness, int octaves, F f, double* next_weight = nullptr) {
  double sum = 0, frequency = 1, weight = 1;
  for (int i = 0; i < octaves; ++i) {
    sum += weight * f(Noise(p * frequency));
    frequency *= kLacunarity;
    weight *= roughness;
  }
  if (next_weight) *next_weight = weight;
  return sum;
}

}  // namespace

double Noise(Vec3d p) {
  if (!(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z))) return 0;
  const Cell x = CellOf(p.x), y = CellOf(p.y), z = CellOf(p.z);
  const auto corner = [&](int i, int j, int k) {
    return Gradient(x.index + i, y.index + j, z.index + k, x.fraction - i, y.fraction - j,
                    z.fraction - k);
  };
  const double wx = Fade(x.fraction), wy = Fade(y.fraction), wz = Fade(z.fraction);
  const auto row = [&](int j, int k) { return Mix(wx, corner(0, j, k), corner(1, j, k)); };
  return Mix(wz, Mix(wy, row(0, 0), row(1, 0)), Mix(wy, row(0, 1), row(1, 1)));
}

double FractalNoise(Vec3d p, double roughness, int octaves) {
  return SumOctaves(p, roughness, octaves, [](double noise) { return noise; });
}

double Turbulence(Vec3d p, double roughness, int octaves) {
  double next = 0;
  const double sum = SumOctaves(
      p, roughness, octaves, [](double noise) { return std::fabs(noise); }, &next);
  return sum + 0.2 * next;  // The mean of what comes next.
}

Rgb EvalNoise(const NoiseTexture& texture, Vec3d p) {
  const auto gray = [](double v) { return Rgb::Gray(static_cast<float>(v)); };
  const double roughness = texture.roughness;
  switch (texture.kind) {
    case NoiseTexture::Kind::kFbm:
      return gray(FractalNoise(p, roughness, texture.octaves));
    case NoiseTexture::Kind::kWrinkled:
      return gray(Turbulence(p, roughness, texture.octaves));
    case NoiseTexture::Kind::kWindy: {
      const double strength = FractalNoise(p * 0.1, 0.5, 3), height = FractalNoise(p, 0.5, 6);
      return gray(std::fabs(strength) * height);
    }
    case NoiseTexture::Kind::kMarble:
      break;
  }
  p = p * static_cast<double>(texture.scale);
  return Marble(p.y + texture.variation * FractalNoise(p, roughness, texture.octaves));
}

bool IsInDot(Vec2f st) {
  constexpr double kRadius = 0.35, kMaxShift = 0.5 - kRadius;
  const double s = std::floor(st.x + 0.5), t = std::floor(st.y + 0.5);
  const auto noise = [&](double ds, double dt) { return Noise({s + ds, t + dt, 0.5}); };
  if (!(noise(0.5, 0.5) > 0)) return false;
  const double x = st.x - (s + kMaxShift * noise(1.5, 2.8));
  const double y = st.y - (t + kMaxShift * noise(4.5, 9.8));
  return x * x + y * y < kRadius * kRadius;
}

}  // namespace strata
