#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "worker/pbrt/context.h"
#include "worker/pbrt/parameters.h"
#include "worker/pbrt/spectrum.h"

// Parameters that hold colours: how an RGB renderer reads pbrt's spectra.

namespace strata {

/// What a spectrum stands for decides how it becomes RGB and which values are allowed.
enum class SpectrumUse {
  kReflectance,  ///< In [0, 1]; RGB as given, other spectra by ReflectanceColor.
  kUnbounded,    ///< Not negative: refractive indices, weights. As reflectances otherwise.
  kIlluminant,   ///< RGB as given; other spectra have luminance 1 (pbrt-v4 scales them so).
};

/// The colour of a parameter of type rgb, blackbody or spectrum. Located errors for other types,
/// values out of range and unknown names. `color_space` is that of rgb values.
absl::StatusOr<Rgb> ReadColor(const Parameter& parameter, SpectrumUse use,
                              std::string_view color_space, ReadContext& context);

/// The spectrum of a parameter of type spectrum or blackbody.
absl::StatusOr<Spectrum> ReadSpectrum(const Parameter& parameter, ReadContext& context);

/// The parameter's colour, or `fallback` when there is none; errors are kept by `parameters`.
Rgb ColorParameter(ParameterReader& parameters, std::string_view name, Rgb fallback,
                   SpectrumUse use, std::string_view color_space, ReadContext& context);

}  // namespace strata
