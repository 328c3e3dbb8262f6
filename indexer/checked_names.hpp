#pragma once

#include <string>

namespace landmarkdb::indexer {

// What is given on the command line to become a name, a tag's key or a tag's value in the database.
// Throw cli::UsageError, as for any other wrong argument; `argument` is its place on the command
// line ("NAME").
void require_name(const std::string& name, const std::string& what, const std::string& argument);
void require_tag_value(const std::string& value, const std::string& argument);

}  // namespace landmarkdb::indexer
