#pragma once

#include "common/status.h"

namespace strata {

/// What the process ends with; scripts rely on it.
enum class ExitStatus {
  kDone = 0,
  kFailed = 1,       ///< The job failed, or a result is not what was asked for or not written.
  kBadInput = 2,     ///< Bad usage or bad input.
  kUnreachable = 3,  ///< No server answered within five seconds.
  kInterrupted = 130,
};

/// What a command that could not do its work ends with.
inline ExitStatus ExitStatusOf(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kOk:
      return ExitStatus::kDone;
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kNotFound:
    case absl::StatusCode::kOutOfRange:
    case absl::StatusCode::kFailedPrecondition:
    case absl::StatusCode::kPermissionDenied:
    case absl::StatusCode::kUnauthenticated:
      return ExitStatus::kBadInput;
    case absl::StatusCode::kUnavailable:
      return ExitStatus::kUnreachable;
    case absl::StatusCode::kCancelled:
      return ExitStatus::kInterrupted;
    default:
      return ExitStatus::kFailed;
  }
}

/// For errors of files on this machine: whatever went wrong, it is not the server's silence.
inline absl::Status AsBadInput(const absl::Status& status) {
  return status.ok() ? status : absl::InvalidArgumentError(status.message());
}

}  // namespace strata
