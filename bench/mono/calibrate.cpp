#include "bench/mono/calibrate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "bench/mono/pictures.hpp"
#include "bench/retrieval/logistic.hpp"

namespace landmarkdb::bench {
namespace {

using nlohmann::json;

// Seeds of scenes and pictures that things are fitted to; each batch of pictures has models of its
// own.
constexpr std::uint64_t kFirstSeed = 1;
constexpr std::size_t kBatch = 50;

PictureOutcomes all_pictures(std::uint64_t seed, const Settings& settings) {
  PictureOutcomes all;
  for (std::size_t first = 0; first < settings.pictures; first += kBatch) {
    PictureOutcomes some = run_pictures({.models = settings.picture_models,
                                         .pictures = std::min(kBatch, settings.pictures - first),
                                         .seed = seed++});
    all.best.insert(all.best.end(), some.best.begin(), some.best.end());
    for (PictureHypothesis& hypothesis : some.told) hypothesis.picture += first;
    all.told.insert(all.told.end(), some.told.begin(), some.told.end());
  }
  return all;
}

void print_bins(const std::vector<double>& confidence, const std::vector<bool>& right) {
  for (int bin = 0; bin < 10; ++bin) {
    double n = 0.0, hits = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < confidence.size(); ++i) {
      if (std::min(9, static_cast<int>(confidence[i] * 10.0)) != bin) continue;
      n += 1.0;
      hits += right[i] ? 1.0 : 0.0;
      sum += confidence[i];
    }
    if (n > 0.0) std::printf("confidence %.2f: %4.0f answers, right %.2f\n", sum / n, n, hits / n);
  }
}

// The mean share of hypotheses' edges that lie on the image's, by length, and the length that
// counts as one trial: what makes the spread of the shares that of a binomial.
json fit_edges(const std::vector<PictureHypothesis>& evidence, bool right) {
  double length_px = 0.0, on_px = 0.0, n = 0.0, spread = 0.0;
  for (const PictureHypothesis& e : evidence) {
    if (e.right != right || !(e.length_px > 0.0)) continue;
    n += 1.0;
    length_px += e.length_px;
    on_px += e.evidence.edge_share * e.length_px;
  }
  const double share = on_px / length_px;
  for (const PictureHypothesis& e : evidence) {
    if (e.right == right)
      spread += (e.evidence.edge_share - share) * (e.evidence.edge_share - share) * e.length_px / n;
  }
  const double together_px = spread / (share * (1.0 - share));
  std::printf("edges of %4.0f %s hypotheses: %.3f on edges of the image, %.0f px together\n",
              n,
              right ? "right" : "wrong",
              share,
              together_px);
  return {{"hypotheses", n}, {"share", share}, {"together_px", together_px}};
}

// Of the first `columns` terms.
json fit_weights(const char* name, const std::vector<Outcome>& rows, std::size_t columns) {
  Eigen::MatrixXd terms(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(columns));
  Eigen::VectorXd right(static_cast<Eigen::Index>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto row = confidence_terms(rows[i].evidence);
    for (std::size_t k = 0; k < columns; ++k)
      terms(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = row[k];
    right(static_cast<Eigen::Index>(i)) = rows[i].right ? 1.0 : 0.0;
  }
  const Eigen::VectorXd weights = fit_logistic(terms, right, {.ridge = 1.0});
  std::printf("weights %s, %zu answers, %.0f right:", name, rows.size(), right.sum());
  for (const double w : weights) std::printf(" %.3f,", w);
  std::printf("\n");
  return {{"answers", rows.size()},
          {"right", right.sum()},
          {"weights", std::vector<double>(weights.data(), weights.data() + weights.size())}};
}

void keep_told(const std::vector<Outcome>& outcomes, std::vector<Outcome>& rows) {
  for (const Outcome& o : outcomes) {
    if (o.told) rows.push_back(o);
  }
}

json rows_of(const std::vector<PictureHypothesis>& told) {
  json rows = json::array();
  for (const PictureHypothesis& h : told) {
    const RecognitionEvidence& e = h.evidence;
    rows.push_back({{"picture", h.picture},
                    {"known", h.known},
                    {"right", h.right},
                    {"confidence", h.confidence},
                    {"length_px", h.length_px},
                    {"log10_nfa", e.log10_nfa},
                    {"margin", e.margin},
                    {"matched", e.matched},
                    {"visible", e.visible},
                    {"rms_px", e.rms_px},
                    {"edge_share", e.edge_share},
                    {"overrun", e.edges.overrun},
                    {"supported", e.edges.supported},
                    {"lined", e.edges.lined},
                    {"bend", e.edges.bend},
                    {"face_odds", e.face_odds},
                    {"shape_odds", e.shape_odds}});
  }
  return rows;
}

}  // namespace

json calibrate(const Settings& settings) {
  std::vector<Outcome> by_points, with_edges;
  std::uint64_t seed = kFirstSeed;
  for (const Case& one : kCases) {
    if (one.features > 100) continue;
    keep_told(run_recognition(options_of(one, settings, seed++)),
              one.edges ? with_edges : by_points);
  }
  const PictureOutcomes pictures = all_pictures(kFirstSeed, settings);
  keep_told(pictures.best, with_edges);
  json result{{"right_edges", fit_edges(pictures.told, true)},
              {"wrong_edges", fit_edges(pictures.told, false)}};
  double least_nfa = 0.0;
  for (const PictureHypothesis& h : pictures.told)
    if (!h.right) least_nfa = std::min(least_nfa, h.evidence.log10_nfa);
  std::printf("least log10 of false alarms of a wrong hypothesis: %.1f\n", least_nfa);
  result["least_wrong_log10_nfa"] = least_nfa;
  result["by_points"] = fit_weights("by points", by_points, kPointTerms);
  result["with_edges"] = fit_weights("with edges", with_edges, kConfidenceTerms);
  result["rows"] = rows_of(pictures.told);
  return result;
}

json reliability(const Settings& settings) {
  const PictureOutcomes pictures = all_pictures(settings.seed, settings);
  std::vector<double> confidence;
  std::vector<bool> right;
  std::size_t known = 0, found = 0, wrong_known = 0, unknown = 0, wrong_unknown = 0;
  for (const Outcome& o : pictures.best) {
    const bool is_known = o.kind == SceneKind::kKnown;
    known += is_known ? 1 : 0;
    unknown += is_known ? 0 : 1;
    found += o.accepted && o.right ? 1 : 0;
    const bool wrong = o.accepted && !o.right;
    wrong_known += is_known && wrong ? 1 : 0;
    wrong_unknown += !is_known && wrong ? 1 : 0;
    if (!o.told) continue;
    confidence.push_back(o.confidence);
    right.push_back(o.right);
  }
  std::printf(
      "%zu pictures with a known object: %zu recognized, %zu wrong\n", known, found, wrong_known);
  std::printf("%zu pictures without one: %zu wrong\n", unknown, wrong_unknown);
  print_bins(confidence, right);
  return {{"known", known},
          {"recognized", found},
          {"wrong_known", wrong_known},
          {"unknown", unknown},
          {"wrong_unknown", wrong_unknown},
          {"rows", rows_of(pictures.told)}};
}

}  // namespace landmarkdb::bench
