#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace landmarkdb::cli {

// Values as they are typed. `option` is how the caller calls the value ("--up"), for the message.
// All throw UsageError when the text is not what it should be; no locale has a say in it.

// "1.5": a finite number and nothing else.
double parse_number(std::string_view text, const std::string& option);

// A finite number above zero; lengths in metres.
double parse_positive(std::string_view text, const std::string& option);

// For an option of whole numbers from zero on, which a number below would wrap to: empty, or what
// is wrong with the text.
std::string not_negative(const std::string& text);

// "x,y,z", finite.
Eigen::Vector3d parse_vector3(std::string_view text, const std::string& option);

// "x,y,z", not zero: a direction.
Eigen::Vector3d parse_direction(std::string_view text, const std::string& option);

// "xmin,ymin,zmin,xmax,ymax,zmax" with min < max on every axis.
struct Box {
  Eigen::Vector3d min_m;
  Eigen::Vector3d max_m;
};
Box parse_box(std::string_view text, const std::string& option);

// 16 numbers, row-major, separated by spaces, commas, semicolons or line ends; brackets (JSON) and
// lines after a '#' do not count. Throws Error{kInvalidArgument} naming `source` when they are not
// 16 finite numbers or no rigid motion.
Eigen::Isometry3d parse_pose(std::string_view text, const std::string& source);

// The same from a file, or, where no file of that name exists, from the text itself when it holds
// 16 numbers (`--prior 1,0,0,...`). Throws Error{kInvalidArgument} naming the file.
Eigen::Isometry3d read_pose(const std::string& file_or_numbers);
Eigen::Isometry3d read_pose_file(const std::filesystem::path& path);

}  // namespace landmarkdb::cli
