#include "client/program.hpp"

#include <iostream>

#include "client/render_json.hpp"

namespace landmarkdb::client {

void Program::print(const nlohmann::ordered_json& object, const std::string& text) const {
  std::cout << (options.json ? dump(object) + '\n' : text);
}

}  // namespace landmarkdb::client
