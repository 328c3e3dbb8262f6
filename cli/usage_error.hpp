#pragma once

#include <stdexcept>
#include <string>

namespace landmarkdb::cli {

// The command line asks for something that cannot be: the program ends with status 2 and a pointer
// to --help. `option` is the option or argument at fault, as it is typed.
class UsageError : public std::runtime_error {
 public:
  UsageError(std::string option, const std::string& message)
      : std::runtime_error(option + ": " + message), option_(std::move(option)) {}

  const std::string& option() const noexcept { return option_; }

 private:
  std::string option_;
};

}  // namespace landmarkdb::cli
