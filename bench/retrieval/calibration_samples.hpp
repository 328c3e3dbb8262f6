#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "bench/retrieval/csv_table.hpp"

namespace landmarkdb::bench {

// One input of the confidence: a column that landmarkdb-bench-retrieval prints, and what is made of
// it.
struct Feature {
  enum class Use { kAlways, kWherePresent, kOnRequest };

  std::string_view name;
  std::string_view column;
  std::string_view formula;  // for people
  double (*value)(double);
  Use use;  // kWherePresent: where all files have the column
};

// All features there are, in the order of the printed weights. This is the place to change.
std::span<const Feature> all_features();

// The features to fit: those `names`, in the table's order, or, when empty, the default ones.
// Throws Error{kInvalidArgument} on a name that is none, or twice.
std::vector<Feature> choose_features(std::span<const CsvTable> tables,
                                     std::span<const std::string> names);

// The queries that ended with a pose, one a row.
struct Samples {
  std::vector<std::string> names;        // of the columns of `features`; the first is the constant
  Eigen::MatrixXd features;              // N x names.size(); the first column is 1
  Eigen::VectorXd right;                 // N: 1 where the best pose was right, else 0
  std::vector<std::size_t> places;       // N: index in place_names
  std::vector<std::string> place_names;  // "FILE PLACE": a place is one of its file
  std::size_t without_pose = 0;  // queries whose evidence is all zero: nothing to be sure of

  std::size_t size() const { return static_cast<std::size_t>(right.size()); }
};

// Throws Error{kInvalidArgument}: a missing column, a figure that is no number, a `right` other
// than 0 and 1 (with file and line), no rows, all right or all wrong, fewer than two places.
Samples make_samples(std::span<const CsvTable> tables, std::span<const Feature> features);

}  // namespace landmarkdb::bench
