#include "bench/retrieval/paper_table.hpp"

#include <cstdio>

#include <nlohmann/json.hpp>

namespace landmarkdb::bench {

namespace {

const std::array<const char*, 6> kColumns = {
    "x_mm", "y_mm", "z_mm", "pitch_deg", "yaw_deg", "roll_deg"};

std::string errors_text(const std::array<double, 6>& errors) {
  char text[100];
  std::snprintf(text,
                sizeof text,
                "%8.2f %8.2f %8.2f %8.2f %8.2f %8.2f",
                errors[0],
                errors[1],
                errors[2],
                errors[3],
                errors[4],
                errors[5]);
  return text;
}

std::string line(const std::string& place,
                 const std::string& method,
                 const std::string& errors,
                 const std::string& rest) {
  char text[300];
  std::snprintf(text,
                sizeof text,
                "%-7s %-34s %s  %s\n",
                place.c_str(),
                method.c_str(),
                errors.c_str(),
                rest.c_str());
  return text;
}

std::string counts_text(const ErrorTally& tally) {
  char text[100];
  std::snprintf(text,
                sizeof text,
                "%zu of %zu, wrong %zu, ambiguous %zu, %.0f ms",
                tally.right.size() + tally.wrong_ones.size(),
                tally.asked,
                tally.wrong_ones.size(),
                tally.ambiguous,
                median(tally.milliseconds));
  return text;
}

nlohmann::json errors_json(const std::array<double, 6>& errors) {
  nlohmann::json out;
  for (std::size_t i = 0; i < errors.size(); ++i) out[kColumns[i]] = errors[i];
  return out;
}

}  // namespace

const std::vector<PublishedRow>& published_rows() {
  static const std::vector<PublishedRow> rows = {
      {"temple", "published: Cocias et al.", {8.89, 33.58, 15.11, 2.54, 1.39, 5.15}},
      {"lobby", "published: Cocias et al.", {11.25, 32.79, 21.35, 3.98, 2.69, 3.35}},
      {"lobby", "published: ARToolKit markers", {10.64, 18.56, 15.25, 2.25, 1.97, 2.75}}};
  return rows;
}

std::string table_text(const std::vector<MeasuredRow>& rows) {
  std::string text = line("place",
                          "method",
                          "    x mm     y mm     z mm    pitch      yaw     roll",
                          "localized, median time");
  for (const char* place : {"temple", "lobby"}) {
    for (const PublishedRow& row : published_rows()) {
      if (row.place == place) text += line(place, row.method, errors_text(row.errors), "-");
    }
    for (const MeasuredRow& row : rows) {
      if (row.place != place) continue;
      const bool any = !row.tally.right.empty() || !row.tally.wrong_ones.empty();
      const std::string none = "       -        -        -        -        -        -";
      text += line(place,
                   row.method,
                   any ? errors_text(row.tally.mean_absolute()) : none,
                   counts_text(row.tally));
    }
  }
  return text;
}

std::string table_json(const std::vector<MeasuredRow>& rows, std::uint64_t seed) {
  nlohmann::json out;
  out["seed"] = seed;
  for (const PublishedRow& row : published_rows()) {
    out["published"].push_back({{"place", row.place},
                                {"method", row.method},
                                {"mean_absolute_error", errors_json(row.errors)}});
  }
  for (const MeasuredRow& row : rows) {
    const std::size_t right = row.tally.right.size();
    const std::size_t wrong = row.tally.wrong_ones.size();
    nlohmann::json one = {{"place", row.place},
                          {"method", row.method},
                          {"asked", row.tally.asked},
                          {"localized", right + wrong},
                          {"right", right},
                          {"wrong", wrong},
                          {"ambiguous", row.tally.ambiguous},
                          {"median_ms", median(row.tally.milliseconds)}};
    one["mean_absolute_error"] =
        right + wrong > 0 ? errors_json(row.tally.mean_absolute()) : nlohmann::json(nullptr);
    out["measured"].push_back(std::move(one));
  }
  return out.dump(2) + "\n";
}

}  // namespace landmarkdb::bench
