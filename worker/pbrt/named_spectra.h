#pragma once

#include <optional>
#include <string_view>

#include "worker/pbrt/spectrum.h"

namespace strata {

/// The spectra that pbrt-v4 files know by name: "stdillum-A|D50|D65|F1..F12", "illum-acesD60",
/// "metal-Ag|Al|Au|Cu|CuZn|MgO|TiO2-eta|k" and "glass-BK7|BAF10|FK51A|LASF9|F5|F10|F11". None for
/// any other name.
std::optional<Spectrum> NamedSpectrum(std::string_view name);

}  // namespace strata
