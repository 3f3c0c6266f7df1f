#include "worker/pbrt/spectrum.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "worker/math/elementary.h"
#include "worker/pbrt/named_spectra.h"

namespace strata {
namespace {

#include "worker/pbrt/cie_tables.inl"

using Matrix3 = std::array<std::array<double, 3>, 3>;
using Xyz = std::array<double, 3>;

constexpr int kFirstNanometre = 360, kLastNanometre = 830;

double AtNanometre(const double* table, int nanometres) {
  const int i = (nanometres - kFirstNanometre) / 5, part = (nanometres - kFirstNanometre) % 5;
  return part == 0 ? table[i] : table[i] + (table[i + 1] - table[i]) * (part / 5.0);
}

/// The integral of `value` times each colour-matching function.
template <typename F>
Xyz Integrate(F value) {
  Xyz xyz{};
  for (int nm = kFirstNanometre; nm <= kLastNanometre; ++nm) {
    const double v = value(nm);
    xyz[0] += v * AtNanometre(kCieX, nm);
    xyz[1] += v * AtNanometre(kCieY, nm);
    xyz[2] += v * AtNanometre(kCieZ, nm);
  }
  return xyz;
}

Xyz Apply(const Matrix3& m, const Xyz& v) {
  Xyz r{};
  for (int i = 0; i < 3; ++i) r[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
  return r;
}

Matrix3 Multiply(const Matrix3& a, const Matrix3& b) {
  Matrix3 product{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) product[i][j] += a[i][k] * b[k][j];
    }
  }
  return product;
}

/// Of a matrix known to be regular, by cofactors.
Matrix3 Inverse(const Matrix3& m) {
  Matrix3 cofactors;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
      cofactors[j][i] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
    }
  }
  const double determinant =
      m[0][0] * cofactors[0][0] + m[0][1] * cofactors[1][0] + m[0][2] * cofactors[2][0];
  for (auto& row : cofactors) {
    for (double& value : row) value /= determinant;
  }
  return cofactors;
}

struct Chromaticity {
  double x, y;
};

Xyz WithUnitLuminance(Chromaticity c) { return {c.x / c.y, 1, (1 - c.x - c.y) / c.y}; }

/// The map of linear RGB to XYZ that takes (1, 1, 1) to `white` (SMPTE RP 177-1993).
Matrix3 RgbToXyz(const std::array<Chromaticity, 3>& primaries, const Xyz& white) {
  Matrix3 m;
  for (int j = 0; j < 3; ++j) {
    const Xyz primary = WithUnitLuminance(primaries[j]);
    for (int i = 0; i < 3; ++i) m[i][j] = primary[i];
  }
  const Xyz scale = Apply(Inverse(m), white);
  for (auto& row : m) {
    for (int j = 0; j < 3; ++j) row[j] *= scale[j];
  }
  return m;
}

/// White and the map to linear Rec.709, from the same tables, so that D65 is exactly white.
struct Rec709 {
  Xyz white_integral;
  Matrix3 from_xyz;
};

constexpr std::array<Chromaticity, 3> kRec709Primaries = {
    {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}}};

const Rec709& GetRec709() {
  static const Rec709 rec709 = [] {
    const Spectrum d65 = *NamedSpectrum("stdillum-D65");
    const Xyz integral = Integrate(d65);
    const Xyz white = {integral[0] / integral[1], 1, integral[2] / integral[1]};
    return Rec709{integral, Inverse(RgbToXyz(kRec709Primaries, white))};
  }();
  return rec709;
}

Rgb ToRgb(const Xyz& xyz) {
  const Xyz rgb = Apply(GetRec709().from_xyz, xyz);
  return {static_cast<float>(rgb[0]), static_cast<float>(rgb[1]), static_cast<float>(rgb[2])};
}

}  // namespace

absl::StatusOr<Spectrum> Spectrum::Create(std::vector<std::pair<double, double>> samples,
                                          Outside outside) {
  if (samples.empty()) return absl::InvalidArgumentError("the spectrum has no samples");
  for (size_t i = 0; i < samples.size(); ++i) {
    if (!std::isfinite(samples[i].first) || !std::isfinite(samples[i].second)) {
      return absl::InvalidArgumentError("the spectrum has a sample that is not finite");
    }
    if (i > 0 && !(samples[i - 1].first < samples[i].first)) {
      return absl::InvalidArgumentError(
          StrCat("the wavelengths of the spectrum do not increase at ", samples[i].first,
                 " nm; sort them"));
    }
  }
  return Spectrum(std::move(samples), outside);
}

Spectrum Spectrum::Blackbody(double kelvin) {
  constexpr double kPlanck = 6.62607015e-34, kLight = 299792458, kBoltzmann = 1.380649e-23;
  std::vector<std::pair<double, double>> samples;
  double largest = 0;
  for (int nm = kFirstNanometre; nm <= kLastNanometre; nm += 5) {
    const double meters = nm * 1e-9;
    const double x = kPlanck * kLight / (meters * kBoltzmann * kelvin);
    const double power = meters * meters * meters * meters * meters;
    const double radiance = 2 * kPlanck * kLight * kLight / (power * (Exp(x) - 1));
    samples.emplace_back(nm, radiance);
    largest = std::max(largest, radiance);
  }
  for (auto& sample : samples) sample.second = largest > 0 ? sample.second / largest : 0;
  return Spectrum(std::move(samples), Outside::kZero);
}

double Spectrum::operator()(double nanometres) const {
  if (nanometres < samples_.front().first) {
    return outside_ == Outside::kHold ? samples_.front().second : 0;
  }
  if (nanometres >= samples_.back().first) {
    const bool at_end = nanometres == samples_.back().first;
    return at_end || outside_ == Outside::kHold ? samples_.back().second : 0;
  }
  const auto above = std::upper_bound(
      samples_.begin(), samples_.end(), nanometres,
      [](double wanted, const std::pair<double, double>& sample) { return wanted < sample.first; });
  const auto below = above - 1;
  const double t = (nanometres - below->first) / (above->first - below->first);
  return below->second + t * (above->second - below->second);
}

Rgb IlluminantColor(const Spectrum& spectrum) {
  const Xyz xyz = Integrate(spectrum);
  if (!(xyz[1] > 0) || !std::isfinite(xyz[1])) return {};
  return ToRgb({xyz[0] / xyz[1], 1, xyz[2] / xyz[1]});
}

Rgb ReflectanceColor(const Spectrum& spectrum) {
  const Spectrum d65 = *NamedSpectrum("stdillum-D65");
  Xyz xyz = Integrate([&](int nm) { return spectrum(nm) * d65(nm); });
  for (double& value : xyz) value /= GetRec709().white_integral[1];
  const Rgb rgb = ToRgb(xyz);
  return {std::max(rgb.r, 0.0f), std::max(rgb.g, 0.0f), std::max(rgb.b, 0.0f)};
}

double AtSodiumLine(const Spectrum& spectrum) { return spectrum(589.3); }

absl::StatusOr<std::array<std::array<double, 3>, 3>> ToRec709(std::string_view color_space) {
  struct Space {
    std::string_view name;
    std::array<Chromaticity, 3> primaries;
  };
  // ITU-R BT.709, SMPTE RP 431-2 with a D65 white, ITU-R BT.2020. All have the same white.
  constexpr Chromaticity kD65 = {0.3127, 0.3290};
  constexpr Space kSpaces[] = {
      {"srgb", kRec709Primaries},
      {"dci-p3", {{{0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}}}},
      {"rec2020", {{{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}}}},
  };
  for (const Space& space : kSpaces) {
    if (space.name != color_space) continue;
    const Xyz white = WithUnitLuminance(kD65);
    return Multiply(Inverse(RgbToXyz(kRec709Primaries, white)), RgbToXyz(space.primaries, white));
  }
  return absl::InvalidArgumentError(
      StrCat("color space \"", color_space, "\" is not supported; use srgb, dci-p3 or rec2020"));
}

}  // namespace strata
