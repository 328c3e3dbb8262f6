#include "engine/retrieval/list_correspondences.hpp"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "engine/matching/descriptor_rows.hpp"
#include "engine/matching/measures.hpp"
#include "engine/retrieval/hypothesis.hpp"

namespace landmarkdb {

namespace {

// One record: two positions of three doubles, a distance, two names, and what protobuf adds.
std::size_t bytes_of(const CorrespondenceRecord& record) {
  constexpr std::size_t kNumbers = 72;
  return kNumbers + record.scene.size() + record.dropped_by.size();
}

// The entry that the answer is about: the best pose's, or where there is none the one whose filters
// left most.
const EntryMatches* matches_of(const Verdict& verdict, const SearchResult& search) {
  if (!verdict.judged.empty()) return &search.matches[verdict.judged[0].pose.matches];
  const auto most =
      std::max_element(search.matches.begin(),
                       search.matches.end(),
                       [](const EntryMatches& a, const EntryMatches& b) {
                         return std::pair(a.counts.after_consistency, a.counts.putative) <
                                std::pair(b.counts.after_consistency, b.counts.putative);
                       });
  return most == search.matches.end() ? nullptr : &*most;
}

// Of each pair, why the frames of its keypoints may not propose a pose; "" where they may.
std::vector<const char*> refused_proposals(const EntryMatches& matches, const SearchInput& input) {
  std::vector<const char*> refused(matches.putative.size(), "");
  const Entry& entry = input.entries[matches.entry];
  if (input.options.profile == Profile::kPaper || entry.is_object()) return refused;
  const auto mark = [&](const char* name,
                        const std::optional<Gravity>& gravity,
                        const std::optional<PositionPrior>& prior) {
    std::vector<bool> proposed(matches.putative.size(), false);
    for (const Proposal& proposal : propose_from_frames(matches.putative,
                                                        entry.record().descriptors,
                                                        matches.view->descriptors,
                                                        gravity,
                                                        prior)) {
      proposed[proposal.correspondence] = true;
    }
    for (std::size_t i = 0; i < refused.size(); ++i) {
      if (!proposed[i] && *refused[i] == '\0') refused[i] = name;
    }
  };
  const std::optional<Gravity> gravity = gravity_of(input.options, entry.record());
  if (gravity) mark("up", gravity, std::nullopt);
  const std::optional<PositionPrior> prior = prior_of(input, entry.record());
  if (prior) mark("prior", gravity, prior);
  return refused;
}

// How many pairs of the same keypoint come before each: they are stored nearest first. An object's
// own keypoints are the ones that have neighbours.
std::vector<std::uint32_t> neighbour_ranks(const EntryMatches& matches, bool object) {
  std::unordered_map<std::uint32_t, std::uint32_t> seen;
  std::vector<std::uint32_t> ranks;
  ranks.reserve(matches.putative.size());
  for (const Correspondence& pair : matches.putative) {
    ranks.push_back(seen[object ? pair.target : pair.query]++);
  }
  return ranks;
}

// Keeps what agrees and the nearest neighbours, in the order of the list.
void cut_to_size(const std::vector<std::uint32_t>& ranks, CorrespondenceList& list) {
  std::vector<std::size_t> order(list.records.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const auto key = [&](std::size_t i) {
      return std::pair(!list.records[i].dropped_by.empty(), ranks[i]);
    };
    return key(a) < key(b);
  });
  std::size_t bytes = 0;
  std::size_t kept = 0;
  while (kept < order.size() && bytes <= kMostCorrespondenceBytes) {
    bytes += bytes_of(list.records[order[kept++]]);
  }
  order.resize(kept);
  std::sort(order.begin(), order.end());
  std::vector<CorrespondenceRecord> records;
  records.reserve(kept);
  for (const std::size_t i : order) records.push_back(std::move(list.records[i]));
  list.cut = kept < list.records.size();
  list.records = std::move(records);
}

// A level's own distances are those of codes: of what is listed the true ones are told, but of
// entries whose descriptors are not always in memory, lest an answer depend on what is.
float distance_of(const Correspondence& pair,
                  const EntryMatches& matches,
                  const Entry& entry,
                  Measure measure) {
  const DescriptorSet& stored = entry.record().descriptors;
  const bool always_there = entry.stored.source == nullptr && !stored.values.empty();
  if (measure != Measure::kL2 || !always_there) return pair.distance;
  return normalised_dissimilarity(Measure::kL2,
                                  descriptor_row(matches.view->descriptors.values, pair.query),
                                  descriptor_row(stored.values, pair.target));
}

}  // namespace

CorrespondenceList list_correspondences(const Verdict& verdict,
                                        const SearchInput& input,
                                        const SearchResult& search) {
  CorrespondenceList list;
  const EntryMatches* const matches = matches_of(verdict, search);
  if (matches == nullptr) return list;
  const Entry& entry = input.entries[matches->entry];
  const SceneRecord& record = entry.record();
  std::vector<std::uint32_t> inliers;
  if (!verdict.judged.empty()) inliers = chain_of(verdict.judged[0], input, *matches).inliers;
  const std::vector<const char*> refused = refused_proposals(*matches, input);
  std::size_t bytes = 0;
  list.records.reserve(matches->putative.size());
  for (std::uint32_t i = 0; i < matches->putative.size(); ++i) {
    const Correspondence& pair = matches->putative[i];
    CorrespondenceRecord row;
    row.scene = record.name;
    row.sensor_m =
        matches->view->descriptors.keypoints[pair.query] + input.query.cloud.origin.cast<float>();
    row.scene_m = record.descriptors.keypoints[pair.target].cast<double>() + record.prepared.origin;
    row.distance = distance_of(pair, *matches, entry, input.options.measure);
    if (!matches->dropped_by.empty() && *matches->dropped_by[i] != '\0') {
      row.dropped_by = matches->dropped_by[i];
    } else if (!std::binary_search(inliers.begin(), inliers.end(), i)) {
      row.dropped_by = *refused[i] != '\0' ? refused[i] : "pose";
    }
    bytes += bytes_of(row);
    list.records.push_back(std::move(row));
  }
  if (bytes > kMostCorrespondenceBytes) {
    cut_to_size(neighbour_ranks(*matches, entry.is_object()), list);
  }
  return list;
}

}  // namespace landmarkdb
