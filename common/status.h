#pragma once

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <absl/strings/str_cat.h>

#include <string_view>
#include <utility>

/// Returns from the enclosing function when `expr`, an absl::Status, is not OK.
#define STRATA_RETURN_IF_ERROR(expr)               \
  do {                                             \
    absl::Status strata_status = (expr);           \
    if (!strata_status.ok()) return strata_status; \
  } while (false)

#define STRATA_CONCAT_INNER(a, b) a##b
#define STRATA_CONCAT(a, b) STRATA_CONCAT_INNER(a, b)
#define STRATA_ASSIGN_OR_RETURN_IMPL(result, lhs, expr) \
  auto result = (expr);                                 \
  if (!result.ok()) return std::move(result).status();  \
  lhs = *std::move(result)

/// Evaluates `expr`, an absl::StatusOr<T>; assigns its value to `lhs` or returns its status.
#define STRATA_ASSIGN_OR_RETURN(lhs, expr) \
  STRATA_ASSIGN_OR_RETURN_IMPL(STRATA_CONCAT(strata_result_, __LINE__), lhs, expr)

namespace strata {

/// The same code with `context` and a colon before the message; OK stays OK.
absl::Status Annotate(const absl::Status& status, std::string_view context);

}  // namespace strata
