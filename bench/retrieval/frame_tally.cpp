#include "bench/retrieval/frame_tally.hpp"

#include <algorithm>
#include <cstdio>
#include <iterator>

#include <nlohmann/json.hpp>

#include "bench/retrieval/pose_errors.hpp"

namespace landmarkdb::bench {

namespace {

double at_share(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const auto last = static_cast<double>(values.size() - 1);
  return values[static_cast<std::size_t>(share * last + 0.5)];
}

double percent(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

template <typename Wanted>
std::vector<AskedFrame> those(const std::vector<AskedFrame>& frames, const Wanted& wanted) {
  std::vector<AskedFrame> kept;
  std::copy_if(frames.begin(), frames.end(), std::back_inserter(kept), wanted);
  return kept;
}

}  // namespace

bool AskedFrame::first() const { return metres <= kRightMetres && degrees <= kRightDegrees; }

FrameTally tally(const std::vector<AskedFrame>& frames) {
  FrameTally tally;
  std::vector<double> metres;
  std::vector<double> degrees;
  std::vector<double> milliseconds;
  tally.asked = frames.size();
  for (const AskedFrame& frame : frames) {
    tally.first += frame.first() ? 1U : 0U;
    tally.right += frame.right() ? 1U : 0U;
    tally.wrong += frame.wrong() ? 1U : 0U;
    tally.ambiguous += frame.status == QueryStatus::kAmbiguous ? 1U : 0U;
    tally.not_found += frame.status == QueryStatus::kNotFound ? 1U : 0U;
    milliseconds.push_back(frame.milliseconds);
    if (!frame.right()) continue;
    metres.push_back(frame.metres);
    degrees.push_back(frame.degrees);
  }
  tally.median_m = median(std::move(metres));
  tally.median_deg = median(std::move(degrees));
  tally.p95_ms = at_share(milliseconds, 0.95);
  tally.median_ms = median(std::move(milliseconds));
  return tally;
}

std::vector<TallyRow> tally_rows(const std::vector<AskedFrame>& frames) {
  std::vector<TallyRow> rows;
  for (const bool gravity : {false, true}) {
    const auto asked = those(frames, [&](const AskedFrame& f) { return f.gravity == gravity; });
    if (asked.empty()) continue;
    const std::string with = gravity ? ", gravity" : ", no gravity";
    const auto known = those(asked, [](const AskedFrame& f) { return !f.stranger(); });
    const auto informative =
        those(known, [](const AskedFrame& f) { return f.normal_spread >= kInformativeSpread; });
    rows.push_back({"all" + with, tally(known)});
    rows.push_back({"informative" + with, tally(informative)});
    rows.push_back({"informative, scanned" + with,
                    tally(those(informative,
                                [](const AskedFrame& f) { return f.scanned >= kMostlyScanned; }))});
    rows.push_back({"strangers" + with,
                    tally(those(asked, [](const AskedFrame& f) { return f.stranger(); }))});
  }
  rows.push_back({"every query", tally(frames)});
  return rows;
}

std::string tally_table(const std::vector<TallyRow>& rows) {
  std::string text;
  for (const TallyRow& row : rows) {
    const FrameTally& t = row.tally;
    char line[300];
    std::snprintf(
        line,
        sizeof line,
        "%-32s asked %4zu, first %5.1f %%, localized right %5.1f %%, wrong %zu (%.2f %%), "
        "ambiguous %zu; median %.4f m %.3f deg, %.0f ms (p95 %.0f)\n",
        row.name.c_str(),
        t.asked,
        percent(t.first, t.asked),
        percent(t.right, t.asked),
        t.wrong,
        percent(t.wrong, t.asked),
        t.ambiguous,
        t.median_m,
        t.median_deg,
        t.median_ms,
        t.p95_ms);
    text += line;
  }
  return text;
}

std::string tally_json(const std::vector<TallyRow>& rows, const std::string& settings) {
  nlohmann::ordered_json out = {{"settings", settings}};
  for (const TallyRow& row : rows) {
    const FrameTally& t = row.tally;
    out["rows"].push_back({{"frames", row.name},
                           {"asked", t.asked},
                           {"right_first", t.first},
                           {"localized_right", t.right},
                           {"localized_wrong", t.wrong},
                           {"ambiguous", t.ambiguous},
                           {"not_found", t.not_found},
                           {"median_m", t.median_m},
                           {"median_deg", t.median_deg},
                           {"median_ms", t.median_ms},
                           {"p95_ms", t.p95_ms}});
  }
  return out.dump(2) + "\n";
}

}  // namespace landmarkdb::bench
