#pragma once

#include "engine/cloud/input.hpp"
#include "engine/cloud/read_cloud.hpp"

namespace landmarkdb {

// An XYZ, PTS, TXT, ASC or CSV cloud: a point a line, columns parted by blanks, tabs,
// commas or semicolons (one kind a line).
//
// Columns: x y z, then nothing, an intensity (skipped), red green blue (whole numbers up to 255) or
// a unit normal, and anything else (skipped). Lines that are empty or start with "#" or "//" are
// skipped, a first line of column names too. A line with a single whole number starts a block of
// that many points (PTS). Throws Error{kInvalidArgument} naming the line.
void parse_text_cloud(const Input& input, const ReadOptions& options, const CloudSink& sink);

}  // namespace landmarkdb
