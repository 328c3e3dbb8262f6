#pragma once

#include <functional>
#include <list>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/registration/propose.hpp"
#include "engine/retrieval/assess.hpp"
#include "engine/retrieval/entries.hpp"
#include "engine/retrieval/entry.hpp"
#include "engine/retrieval/index_cache.hpp"
#include "engine/retrieval/level.hpp"
#include "engine/retrieval/query_view.hpp"
#include "engine/types/correspondence.hpp"
#include "engine/types/query.hpp"

namespace landmarkdb {

// The query at every resolution that was asked for, made on first use; empty at one it cannot be
// described at.
class ViewCache {
 public:
  ViewCache(const CleanQuery& query,
            std::uint64_t seed,
            const RunContext& context,
            StageTimings& timings)
      : query_(query), seed_(seed), context_(context), timings_(timings) {}

  const QueryView& at(const FeatureOptions& options);
  // The same of the part of the query that is dense enough for that resolution: an object stands
  // somewhere in it, and the walls behind need not be seen as closely.
  const QueryView& dense_at(const FeatureOptions& options);
  std::size_t keypoints() const;  // of the finest view made

 private:
  struct Made {
    FeatureOptions options;
    QueryView view;
  };
  const CleanQuery& query_;
  std::uint64_t seed_;
  const RunContext& context_;
  StageTimings& timings_;
  const QueryView& add(const FeatureOptions& options,
                       const std::function<QueryView()>& make,
                       std::list<Made>& made);
  std::list<Made> made_;  // a list: references stay valid
  std::list<Made> dense_;
};

// A part of a query thinner than this has too few points in a descriptor's support to look like an
// object's surface.
inline constexpr double kMostSpacingVoxels = 2.5;

// What the searches share. `wanted[i]`: entry i may answer. A search loads the entries it looks at
// closely.
struct SearchInput {
  const CleanQuery& query;
  const QueryOptions& options;
  Entries& entries;
  std::span<const Level> levels;
  const std::vector<bool>& wanted;
  ViewCache& views;
  IndexCache& indexes;
  StageTimings& timings;
  const RunContext& context;
};

// How many poses of one entry reached each step.
struct PoseCounts {
  std::uint64_t proposals = 0;  // tested on the surface
  std::uint64_t survivors = 0;  // distinct ones that did well there
  std::uint64_t refined = 0;    // of those, within the quota of all entries
  std::uint64_t verified = 0;   // refined with all points and held against free space
};

// The putative pairs of the query with one entry, and what each filter left of them.
struct EntryMatches {
  std::size_t entry = 0;
  const QueryView* view = nullptr;
  std::vector<Correspondence> putative;  // `query`: keypoint of the view, `target`: of the entry
  std::vector<const char*> dropped_by;   // empty, or one a putative pair; "" where it was kept
  CorrespondenceCounts counts;
  PoseCounts poses;
  bool by_planes = false;  // poses that lay planes on planes are tested too
  // The paper's search: the ratio that would leave four pairs; 0 where none does.
  double ratio_for_four = 0.0;
};

struct SearchResult {
  std::vector<EntryMatches> matches;
  std::vector<Assessed> poses;  // finely assessed, in no order
  std::string lost_at;          // the stage that had nothing left, when `poses` is empty
  // The working resolution at which an entry that the query was too thin for would have been
  // searched; 0: none was.
  double needs_voxel_m = 0.0;
};

// The robust profile: every match proposes a pose through the two local reference frames, every
// proposal is tested on the surface, the best are refined and assessed. Places first, then objects
// in the query.
void search_places(const SearchInput& input, SearchResult& result);
void search_objects(const SearchInput& input, SearchResult& result);

// What is tested of an entry: a pose from each putative pair, and those that lay planes on planes.
std::vector<Proposal> propose(const SearchInput& input, const EntryMatches& matches);

// The first step of search_places: the places that have matches, each with its pairs.
void match_places(const SearchInput& input, SearchResult& result);

// Plane distance at which a point lies on the entry's surface: that of the finest entry asked, so
// that entries of different resolution compete fairly, but not less than the entry can tell.
double common_tolerance_m(const SearchInput& input, const Entry& entry);

// The paper's way, place by place: nearest neighbours, ratio and slope filter, similarity by random
// samples.
void search_paper(const SearchInput& input, SearchResult& result);

// How the query is described for an entry: as the entry was, but for the keypoints where they are
// named.
FeatureOptions query_features(FeatureOptions of_entry, const QueryOptions& options);

// The index the options ask for, over the descriptors of this entry, or of this level: kept from
// query to query, but for levels that were made for the query.
std::shared_ptr<const DescriptorIndex> index_over(const SearchInput& input, std::size_t entry);
std::shared_ptr<const DescriptorIndex> index_over(const SearchInput& input, const Level& level);

// The gravity that query and entry agree to use: nullopt where one of them does not know it.
std::optional<Gravity> gravity_of(const QueryOptions& options, const SceneRecord& record);

// Where the asker expects the sensor, in the coordinates of the record's points.
std::optional<PositionPrior> prior_of(const SearchInput& input, const SceneRecord& record);

// Refines the ranked candidates of all entries in two passes and appends the best to
// `result.poses`.
struct Candidate {
  std::size_t matches = 0;
  Eigen::Isometry3d T_entry_sensor = Eigen::Isometry3d::Identity();
  float score = 0.0F;
  std::uint32_t correspondence = 0;
};
using MeetingOf = std::function<Meeting(const EntryMatches&)>;
void assess_candidates(const SearchInput& input,
                       std::vector<Candidate> candidates,
                       const MeetingOf& meeting_of,
                       SearchResult& result);

}  // namespace landmarkdb
