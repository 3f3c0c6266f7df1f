#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/status.h"
#include "worker/pbrt/context.h"
#include "worker/pbrt/parameters.h"

// Files of pbrt-v3, where they differ from those of pbrt-v4 in words.

namespace strata {

/// Says in v4's words what `directive` of the given type and parameters says in v3's; what is in
/// v4's already stays. Each word that was translated is noted as a warning. A word of v3 whose
/// meaning v4 has no word for is INVALID_ARGUMENT, located at `where`, naming what to use instead.
absl::Status TranslateVersion3(std::string_view directive, const SourceLocation& where,
                               std::string* type, std::vector<Parameter>* parameters,
                               WarningList* warnings);

/// The same of the type of a texture's values.
void TranslateTextureType(const SourceLocation& where, std::string* value_type,
                          WarningList* warnings);

/// The same of a directive's own name, where v4 calls it by another: SurfaceIntegrator.
std::string_view DirectiveOfVersion3(std::string_view name, const SourceLocation& where,
                                     WarningList* warnings);

}  // namespace strata
