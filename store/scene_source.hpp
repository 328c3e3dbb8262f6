#pragma once

#include <memory>
#include <string>

#include "engine/types/scene_source.hpp"
#include "store/scene_rows.hpp"
#include "store/store_types.hpp"

namespace landmarkdb {

// One version in the database file at `path`, read when it is asked for, through a connection of
// its own: what lies there by then is served only if its digest is the one known now.
std::shared_ptr<const SceneSource> make_scene_source(std::string path, VersionRow row);

}  // namespace landmarkdb
