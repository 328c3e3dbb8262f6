#include "bench/retrieval/calibration_samples.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/error.hpp"

namespace landmarkdb::bench {

namespace {

constexpr double kFullMargin = 0.4;          // as in engine/retrieval/confidence.cpp
constexpr double kFullObservability = 0.05;  // likewise
constexpr double kHardlyAny = 0.003;         // likewise
constexpr double kFullStructure = 0.3;       // as in engine/retrieval/object_confidence.cpp

double as_it_is(double x) { return x; }
double log_count(double x) { return std::log1p(std::max(x, 0.0)); }
double log_share(double x) { return std::log1p(std::max(x, 0.0) / kHardlyAny); }

constexpr auto kAlways = Feature::Use::kAlways;
constexpr auto kWherePresent = Feature::Use::kWherePresent;
constexpr auto kOnRequest = Feature::Use::kOnRequest;

const Feature kFeatures[] = {
    {"margin",
     "margin",
     "min(margin, 0.4)",
     [](double x) { return std::min(x, kFullMargin); },
     kAlways},
    {"observability",
     "observability",
     "min(1, observability / 0.05)",
     [](double x) { return std::min(1.0, x / kFullObservability); },
     kAlways},
    {"explained", "explained", "explained", as_it_is, kAlways},
    {"overlap", "overlap", "overlap", as_it_is, kAlways},
    {"crossed", "crossed", "crossed", as_it_is, kAlways},
    {"log_inliers", "inliers", "log(1 + inliers)", log_count, kAlways},
    {"contrast", "contrast", "contrast", as_it_is, kWherePresent},
    {"log_contradicted", "contradicted", "log(1 + contradicted / 0.003)", log_share, kWherePresent},
    {"log_agreeing", "agreeing", "log(1 + agreeing)", log_count, kOnRequest},
    {"log_refuted", "refuted", "log(1 + refuted / 0.003)", log_share, kOnRequest},
    {"quality", "quality", "quality", as_it_is, kOnRequest},
    {"coverage", "coverage", "coverage", as_it_is, kOnRequest},
    {"outgrown", "outgrown", "outgrown", as_it_is, kOnRequest},
    {"closeness", "closeness", "closeness", as_it_is, kOnRequest},
    {"structure",
     "structure",
     "min(1, structure / 0.3)",
     [](double x) { return std::min(1.0, x / kFullStructure); },
     kOnRequest},
    {"confirmed", "confirmed", "confirmed", as_it_is, kOnRequest},
    {"continued", "continued", "continued", as_it_is, kOnRequest},
    {"log_seen", "seen_points", "log(1 + seen points)", log_count, kOnRequest},
};

std::string known_names() {
  std::string text;
  for (const Feature& feature : kFeatures) {
    text += (text.empty() ? "" : ", ") + std::string(feature.name);
  }
  return text;
}

void check_names(std::span<const std::string> names) {
  for (const std::string& name : names) {
    const auto same = [&](const Feature& feature) { return feature.name == name; };
    if (std::none_of(std::begin(kFeatures), std::end(kFeatures), same)) {
      throw Error(ErrorCode::kInvalidArgument,
                  "feature '" + name + "' is unknown, want some of " + known_names(),
                  "--features");
    }
    if (std::count(names.begin(), names.end(), name) > 1) {
      throw Error(ErrorCode::kInvalidArgument,
                  "feature '" + name + "' comes twice, want each once",
                  "--features");
    }
  }
}

std::size_t need_column(const CsvTable& table, std::string_view column) {
  const std::size_t found = table.find(column);
  if (found == table.columns.size()) {
    throw Error(ErrorCode::kInvalidArgument,
                table.file + ": has no column '" + std::string(column) +
                    "', want the output of landmarkdb-bench-retrieval");
  }
  return found;
}

// Whether any figure of evidence that the row has, fitted or not, is other than zero.
bool has_pose(const CsvTable& table, const CsvRow& row) {
  for (const Feature& feature : kFeatures) {
    const std::size_t column = table.find(feature.column);
    if (column < table.columns.size() && csv_number(table, row, column) != 0.0) return true;
  }
  return false;
}

bool read_right(const CsvTable& table, const CsvRow& row, std::size_t column) {
  const double value = csv_number(table, row, column);
  if (value != 0.0 && value != 1.0) {
    throw Error(ErrorCode::kInvalidArgument,
                table.file + ":" + std::to_string(row.line) + ": right is '" + row.fields[column] +
                    "', want 0 or 1");
  }
  return value == 1.0;
}

struct RowsRead {
  std::vector<double> features;  // N rows of names.size(), one after the other
  std::vector<double> right;
};

void read_table(const CsvTable& table,
                std::span<const Feature> features,
                RowsRead& read,
                Samples& samples) {
  const std::size_t right = need_column(table, "right");
  const std::size_t place = need_column(table, "place");
  const std::size_t catalog = table.find("catalog");  // places of two catalogues share their names
  std::vector<std::size_t> columns;
  for (const Feature& feature : features) columns.push_back(need_column(table, feature.column));
  for (const CsvRow& row : table.rows) {
    const bool is_right = read_right(table, row, right);
    if (!has_pose(table, row)) {
      ++samples.without_pose;
      continue;
    }
    read.right.push_back(is_right ? 1.0 : 0.0);
    read.features.push_back(1.0);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      read.features.push_back(features[i].value(csv_number(table, row, columns[i])));
    }
    const bool numbered = catalog < table.columns.size();
    const std::string name =
        table.file + " " + (numbered ? row.fields[catalog] + " " : "") + row.fields[place];
    const auto known = std::find(samples.place_names.begin(), samples.place_names.end(), name);
    samples.places.push_back(static_cast<std::size_t>(known - samples.place_names.begin()));
    if (known == samples.place_names.end()) samples.place_names.push_back(name);
  }
}

void check_enough(const Samples& samples) {
  const auto fail = [](const std::string& why) { throw Error(ErrorCode::kInvalidArgument, why); };
  if (samples.size() == 0) fail("no rows with a pose, want right and wrong ones of several places");
  const double right = samples.right.sum();
  if (right == 0.0) fail("all rows are wrong, want right ones too");
  if (right == static_cast<double>(samples.size())) fail("all rows are right, want wrong ones too");
  if (samples.place_names.size() < 2) {
    fail("all rows are of one place, '" + samples.place_names[0] + "', want two or more");
  }
}

}  // namespace

std::span<const Feature> all_features() { return kFeatures; }

std::vector<Feature> choose_features(std::span<const CsvTable> tables,
                                     std::span<const std::string> names) {
  check_names(names);
  std::vector<Feature> chosen;
  for (const Feature& feature : kFeatures) {
    const bool asked = std::find(names.begin(), names.end(), feature.name) != names.end();
    const bool present = std::all_of(tables.begin(), tables.end(), [&](const CsvTable& table) {
      return table.find(feature.column) < table.columns.size();
    });
    const bool usual = feature.use == kAlways || (feature.use == kWherePresent && present);
    if (names.empty() ? usual : asked) chosen.push_back(feature);
  }
  return chosen;
}

Samples make_samples(std::span<const CsvTable> tables, std::span<const Feature> features) {
  Samples samples;
  samples.names.emplace_back("constant");
  for (const Feature& feature : features) samples.names.emplace_back(feature.name);
  RowsRead read;
  for (const CsvTable& table : tables) read_table(table, features, read, samples);
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto rows = static_cast<Eigen::Index>(read.right.size());
  const auto columns = static_cast<Eigen::Index>(samples.names.size());
  samples.features = Eigen::Map<const RowMajor>(read.features.data(), rows, columns);
  samples.right = Eigen::Map<const Eigen::VectorXd>(read.right.data(), rows);
  check_enough(samples);
  return samples;
}

}  // namespace landmarkdb::bench
