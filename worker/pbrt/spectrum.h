#pragma once

#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "common/status.h"
#include "common/text.h"
#include "worker/math/vec.h"

// Spectra as an RGB renderer reads them: by the CIE 1931 colour-matching functions of the 2 degree
// observer, integrated every nanometre from 360 to 830 nm, into linear Rec.709.

namespace strata {

/// Values at wavelengths in nm, increasing; linear in between.
class Spectrum {
 public:
  /// What a spectrum is beyond its samples: pbrt-v4 takes 0; the tables of refractive indices are
  /// held at their ends.
  enum class Outside { kZero, kHold };

  /// INVALID_ARGUMENT when empty, not increasing or not finite.
  static absl::StatusOr<Spectrum> Create(std::vector<std::pair<double, double>> samples,
                                         Outside outside = Outside::kZero);
  /// Planck's law at `kelvin` > 0, every 5 nm, scaled to 1 at its largest.
  static Spectrum Blackbody(double kelvin);

  double operator()(double nanometres) const;

 private:
  Spectrum(std::vector<std::pair<double, double>> samples, Outside outside)
      : samples_(std::move(samples)), outside_(outside) {}

  std::vector<std::pair<double, double>> samples_;
  Outside outside_;
};

/// The colour of the spectrum as radiance with luminance 1, as pbrt-v4 scales the spectra of
/// lights. Black where the spectrum has no luminance.
Rgb IlluminantColor(const Spectrum& spectrum);

/// The spectrum weighted by D65, relative to D65 itself: a constant c becomes (c, c, c). Meant for
/// reflectances and for the refractive indices of metals. Negative components become 0.
Rgb ReflectanceColor(const Spectrum& spectrum);

/// The spectrum's value at the sodium D line, 589.3 nm, where refractive indices are stated.
double AtSodiumLine(const Spectrum& spectrum);

/// The linear map from the colour space "srgb", "dci-p3" or "rec2020" to Rec.709.
/// INVALID_ARGUMENT for any other name.
absl::StatusOr<std::array<std::array<double, 3>, 3>> ToRec709(std::string_view color_space);

}  // namespace strata
