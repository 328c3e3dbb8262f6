#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace landmarkdb {

// What went wrong, in the gRPC code names; the same numbers travel on the wire.
enum class ErrorCode {
  kCancelled = 1,
  kUnknown = 2,
  kInvalidArgument = 3,  // an input file, cloud or request that cannot be used
  kDeadlineExceeded = 4,
  kNotFound = 5,  // a scene, version or landmark that is not there
  kAlreadyExists = 6,
  kPermissionDenied = 7,
  kResourceExhausted = 8,  // a limit, memory, or a full disk
  kFailedPrecondition = 9,
  kAborted = 10,
  kOutOfRange = 11,
  kUnimplemented = 12,  // a file or protocol of a version this program does not speak
  kInternal = 13,
  kUnavailable = 14,  // a busy port, a locked database, a server that is not there
  kDataLoss = 15,     // a damaged database or segment
  kUnauthenticated = 16,
};

// "INVALID_ARGUMENT" and so on; "UNKNOWN" for a number that is no code.
std::string_view error_code_name(ErrorCode code);

// The exit status the three programs end with for an error of this code.
int exit_status(ErrorCode code);

// The input or the world is at fault. The message names the thing, what was seen and what was
// wanted.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message, std::string field = {});

  ErrorCode code() const noexcept { return code_; }
  // The request field or option at fault, where it helps; empty otherwise.
  const std::string& field() const noexcept { return field_; }

 private:
  ErrorCode code_;
  std::string field_;
};

}  // namespace landmarkdb
