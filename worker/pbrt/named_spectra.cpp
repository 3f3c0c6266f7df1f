#include "worker/pbrt/named_spectra.h"

#include <absl/strings/numbers.h>

#include <algorithm>
#include <iterator>

#include "worker/math/elementary.h"

namespace strata {
namespace {

#include "worker/pbrt/cie_tables.inl"
#include "worker/pbrt/metal_tables.inl"

using Samples = std::vector<std::pair<double, double>>;

/// Of tables that are known to be sound.
Spectrum Make(Samples samples, Spectrum::Outside outside) {
  std::sort(samples.begin(), samples.end());
  return *Spectrum::Create(std::move(samples), outside);
}

Spectrum FromEnergies(const double (&values)[kEvSamples]) {
  constexpr double kNanometreEv = 1239.841984;  // h c / e
  Samples samples;
  for (int i = 0; i < kEvSamples; ++i) {
    samples.emplace_back(kNanometreEv / (kFirstEv - i * kStepEv), values[i]);
  }
  return Make(std::move(samples), Spectrum::Outside::kHold);
}

Spectrum FromBrass(const double (&values)[kBrassSamples]) {
  Samples samples;
  for (int i = 0; i < kBrassSamples; ++i) samples.emplace_back(380 + 20 * i, values[i]);
  return Make(std::move(samples), Spectrum::Outside::kHold);
}

template <size_t N>
Spectrum FromPairs(const double (&pairs)[N][2]) {
  Samples samples;
  for (const auto& pair : pairs) samples.emplace_back(pair[0], pair[1]);
  return Make(std::move(samples), Spectrum::Outside::kHold);
}

Spectrum Constant(double value) { return Make({{360, value}}, Spectrum::Outside::kHold); }

/// CIE daylight of a correlated colour temperature of 4000 to 25000 K (CIE 015:2018, 4.1.2).
Spectrum Daylight(double kelvin) {
  const double t = 1000 / kelvin;
  const double x = kelvin <= 7000 ? ((-4.6070 * t + 2.9678) * t + 0.09911) * t + 0.244063
                                  : ((-2.0064 * t + 1.9018) * t + 0.24748) * t + 0.237040;
  const double y = (-3.000 * x + 2.870) * x - 0.275;
  const double m = 0.0241 + 0.2562 * x - 0.7341 * y;
  const double m1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / m;
  const double m2 = (0.0300 - 31.4424 * x + 30.0717 * y) / m;
  Samples samples;
  for (size_t i = 0; i < std::size(kDaylight0); ++i) {
    samples.emplace_back(360 + 5.0 * i, kDaylight0[i] + m1 * kDaylight1[i] + m2 * kDaylight2[i]);
  }
  return Make(std::move(samples), Spectrum::Outside::kZero);
}

/// CIE standard illuminant A (CIE 015:2018, 4.1.1).
Spectrum Incandescent() {
  Samples samples;
  for (int nm = 300; nm <= 830; nm += 5) {
    const double ratio = 560.0 / nm;
    samples.emplace_back(nm, 100 * ratio * ratio * ratio * ratio * ratio *
                                 (Exp(1.435e7 / (2848 * 560.0)) - 1) /
                                 (Exp(1.435e7 / (2848.0 * nm)) - 1));
  }
  return Make(std::move(samples), Spectrum::Outside::kZero);
}

std::optional<Spectrum> Illuminant(std::string_view name) {
  // The daylight illuminants were named before the radiation constant c2 was last revised.
  constexpr double kRevision = 1.4388 / 1.4380;
  if (name == "A") return Incandescent();
  if (name == "D50") return Daylight(5000 * kRevision);
  if (name == "D65") return Daylight(6500 * kRevision);
  int number = 0;
  if (!name.starts_with('F')) return std::nullopt;
  if (!absl::SimpleAtoi(absl::string_view(name.data() + 1, name.size() - 1), &number) ||
      number < 1 || number > 12) {
    return std::nullopt;
  }
  Samples samples;
  for (int i = 0; i < 81; ++i) samples.emplace_back(380 + 5.0 * i, kFluorescent[number - 1][i]);
  return Make(std::move(samples), Spectrum::Outside::kZero);
}

std::optional<Spectrum> Metal(std::string_view name) {
  if (name == "Ag-eta") return FromEnergies(kSilverEta);
  if (name == "Ag-k") return FromEnergies(kSilverK);
  if (name == "Al-eta") return FromEnergies(kAluminiumEta);
  if (name == "Al-k") return FromEnergies(kAluminiumK);
  if (name == "Au-eta") return FromEnergies(kGoldEta);
  if (name == "Au-k") return FromEnergies(kGoldK);
  if (name == "Cu-eta") return FromEnergies(kCopperEta);
  if (name == "Cu-k") return FromEnergies(kCopperK);
  if (name == "CuZn-eta") return FromBrass(kBrassEta);
  if (name == "CuZn-k") return FromBrass(kBrassK);
  if (name == "MgO-eta") return FromPairs(kMagnesiumOxide);
  if (name == "TiO2-eta") return FromPairs(kTitaniumDioxide);
  if (name == "MgO-k" || name == "TiO2-k") return Constant(0);
  return std::nullopt;
}

}  // namespace

std::optional<Spectrum> NamedSpectrum(std::string_view name) {
  constexpr std::string_view kIlluminant = "stdillum-", kMetal = "metal-";
  if (name.starts_with(kIlluminant)) return Illuminant(name.substr(kIlluminant.size()));
  if (name.starts_with(kMetal)) return Metal(name.substr(kMetal.size()));
  if (name == "illum-acesD60") return Daylight(6000 * 1.4388 / 1.4380);
  for (const NamedGlass& glass : kGlasses) {
    if (name == glass.name) return Constant(glass.eta);
  }
  return std::nullopt;
}

}  // namespace strata
