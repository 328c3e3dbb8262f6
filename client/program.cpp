#include "client/program.hpp"

#include <iostream>

#include "cli/table.hpp"
#include "client/render_json.hpp"

namespace landmarkdb::client {

void Program::print(const nlohmann::ordered_json& object, const std::string& text) const {
  std::cout << (options.json ? dump(object) + '\n' : cli::printable_lines(text));
}

}  // namespace landmarkdb::client
