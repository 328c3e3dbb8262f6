#include "engine/mono/vote_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>

#include "engine/mono/point_pose.hpp"

namespace landmarkdb {
namespace {

// Figures of a prototype, kept as they are.
constexpr double kCodeTolerance = 0.05, kMostTolerance = 0.1, kNoise_px = 1.5;
constexpr double kCell_px = 24.0;
constexpr double kAngles = 12.0;
constexpr double kDepthsAnEFold = 4.0;
constexpr std::size_t kFeaturesOfABin = 5;
constexpr std::size_t kMostBins = 800;
constexpr std::size_t kLeastBins = 8;  // of a model
constexpr std::size_t kMostVotes = 600000;
constexpr std::size_t kCounters = std::size_t{1} << 16U;

struct Vote {
  std::uint64_t bin = 0;
  std::uint32_t image_quad = 0;  // bits 0, 1: A and B, C and D are exchanged
  std::uint32_t model_quad = 0;
  std::uint8_t miss = 0;  // of the code, in eighths of the tolerance
};

std::size_t counter_of(std::uint64_t bin) { return (bin * 0x9e3779b97f4a7c15ULL) >> 48U; }

// An image quad's points in the order of variant `v`.
std::array<std::uint16_t, 4> ordered(const ImageQuad& quad, unsigned v) {
  std::array<std::uint16_t, 4> ids = quad.ids;
  if (v & 1U) std::swap(ids[0], ids[1]);
  if (v & 2U) std::swap(ids[2], ids[3]);
  return ids;
}

std::uint8_t signature_of(const ImageView& image, const std::array<std::uint16_t, 4>& ids) {
  unsigned signature = 0;
  for (std::size_t k = 0; k < 4; ++k)
    signature |= static_cast<unsigned>(image[ids[k]].type) << (2 * k);
  return static_cast<std::uint8_t>(signature);
}

struct Lookup {
  std::uint8_t signature = 0;
  std::uint8_t variant = 0;
  std::uint32_t number = 0;  // of the image quad
  float tolerance = 0.0F;
  std::array<float, 4> code{};
};

class Ballot {
 public:
  Ballot(const QuadIndex& index, const ImageView& image, const VoteOptions& options)
      : index_(index), image_(image), options_(options), counts_(kCounters, 0) {}

  // Notes what is to be looked up for a quad: its code, and those that noise could have made of it
  // where A and B, or C and D, are nearly in the other order.
  void add(const ImageQuad& quad, std::uint32_t number) {
    const float tolerance = static_cast<float>(
        std::min(kMostTolerance, kCodeTolerance + kNoise_px / double{quad.length_px}));
    const bool either_end = std::abs(quad.code[0] + quad.code[2] - 1.0F) < 2.0F * tolerance;
    const bool either_way = std::abs(quad.code[0] - quad.code[2]) < 2.0F * tolerance;
    for (unsigned v = 0; v < 4; ++v) {
      std::array<float, 4> c = quad.code;
      unsigned variant = v;
      if (v & 1U) {
        if (!either_end) continue;
        // From B's side x falls where it rose: C and D change places with it.
        c = {1.0F - c[2], 1.0F - c[3], 1.0F - c[0], 1.0F - c[1]};
        variant ^= 2U;
      }
      if (v & 2U) {
        if (!either_way) continue;
        c = {c[2], c[3], c[0], c[1]};
      }
      lookups_.push_back({signature_of(image_, ordered(quad, variant)),
                          static_cast<std::uint8_t>(variant),
                          number,
                          tolerance,
                          c});
    }
  }

  // Looks all up, in the order of the index: what is looked at next is then still in the cache.
  void vote(std::span<const ImageQuad> quads, const RunContext& run) {
    std::sort(lookups_.begin(), lookups_.end(), [](const Lookup& a, const Lookup& b) {
      return std::tie(a.signature, a.code, a.number, a.variant) <
             std::tie(b.signature, b.code, b.number, b.variant);
    });
    constexpr std::size_t kCheckEvery = 512;
    for (std::size_t i = 0; i < lookups_.size() && !is_full(); ++i) {
      if (i % kCheckEvery == 0) run.check("lookup");
      const Lookup& lookup = lookups_[i];
      vote_variant(
          quads[lookup.number], lookup.number, lookup.variant, lookup.code, lookup.tolerance);
    }
  }

  std::vector<Vote>& votes() { return votes_; }
  unsigned count(std::uint64_t bin) const { return counts_[counter_of(bin)]; }
  bool is_full() const { return votes_.size() >= kMostVotes; }

 private:
  void vote_variant(const ImageQuad& quad,
                    std::uint32_t number,
                    unsigned variant,
                    const std::array<float, 4>& code,
                    float tolerance) {
    const std::array<std::uint16_t, 4> ids = ordered(quad, variant);
    // What is joined in the image is an edge of the model: an edge may be missed, not made up.
    const std::uint8_t links =
        link_mask(ids, [&](std::uint16_t a, std::uint16_t b) { return image_.linked(a, b); });
    const Eigen::Vector2d A = image_[ids[0]].xy, AB = image_[ids[1]].xy - A;
    const double angle = std::atan2(AB.y(), AB.x());
    // The frame's inverse: code (x, y) is A + (x (AB - n) + y (AB + n)) / 2 with n = AB turned by
    // 90 degrees.
    const Eigen::Vector2d n(-AB.y(), AB.x());
    index_.near(signature_of(image_, ids), code, tolerance, [&](const ModelQuad& hit) {
      if ((links & ~hit.links) != 0 || !options_.wanted[hit.model] || votes_.size() >= kMostVotes)
        return;
      const double z = image_.focal_px() * double{hit.length_m} / double{quad.length_px};
      if (z < options_.min_depth_m || z > options_.max_depth_m) return;
      const Eigen::Vector2d origin = A + 0.5 * (hit.origin_x * (AB - n) + hit.origin_y * (AB + n));
      const double turn = (angle - double{hit.angle_rad}) / (2.0 * std::numbers::pi);
      const auto part = [](double x, unsigned bits) {
        return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(x))) &
               ((1ULL << bits) - 1);
      };
      Vote vote;
      vote.bin = (std::uint64_t{hit.model} << 40U) | (std::uint64_t{hit.view} << 32U) |
                 (part(origin.x() / kCell_px, 11) << 21U) |
                 (part(origin.y() / kCell_px, 11) << 10U) |
                 (part((turn - std::floor(turn)) * kAngles, 4) << 6U) |
                 part(std::log(z) * kDepthsAnEFold, 6);
      vote.image_quad = number << 2U | variant;
      vote.model_quad = static_cast<std::uint32_t>(&hit - index_.quads().data());
      float miss = 0.0F;
      for (std::size_t k = 0; k < 4; ++k) miss = std::max(miss, std::abs(hit.code[k] - code[k]));
      vote.miss = static_cast<std::uint8_t>(std::min(7.0F, 8.0F * miss / tolerance));
      std::uint8_t& counter = counts_[counter_of(vote.bin)];
      if (counter < 255) ++counter;
      votes_.push_back(vote);
    });
  }

  const QuadIndex& index_;
  const ImageView& image_;
  const VoteOptions& options_;
  std::vector<Lookup> lookups_;
  std::vector<std::uint8_t> counts_;
  std::vector<Vote> votes_;
};

struct Pair {
  std::uint16_t model, image;
};

// Poses from pairs by 4.1, each into the pool.
void try_pairs(std::span<const SearchModel> models,
               const ImageView& image,
               std::uint32_t model,
               std::span<const Pair> pairs,
               CandidatePool& pool) {
  constexpr std::size_t kMostPairs = 24;
  std::array<Eigen::Vector3d, kMostPairs> xyz;
  std::array<Eigen::Vector2d, kMostPairs> rays;
  const std::size_t n = std::min(pairs.size(), kMostPairs);
  for (std::size_t i = 0; i < n; ++i) {
    xyz[i] = models[model].points[pairs[i].model].xyz;
    rays[i] = image[pairs[i].image].xy / image.focal_px();
  }
  const StartPoses start = start_poses(std::span(xyz).first(n), std::span(rays).first(n));
  for (int b = 0; b < start.count; ++b)
    pool.try_pose(model, start.poses[static_cast<std::size_t>(b)]);
}

// The pairs of a bin's votes: each model point with the image point that most votes give it.
std::vector<Pair> pairs_of(std::span<const Vote> votes,
                           const QuadIndex& index,
                           std::span<const ImageQuad> quads) {
  std::vector<std::uint32_t> all;  // model << 16 | image
  for (const Vote& vote : votes) {
    const std::array<std::uint16_t, 4> ids =
        ordered(quads[vote.image_quad >> 2U], vote.image_quad & 3U);
    const ModelQuad& hit = index.quads()[vote.model_quad];
    for (std::size_t k = 0; k < 4; ++k) all.push_back(std::uint32_t{hit.ids[k]} << 16U | ids[k]);
  }
  std::sort(all.begin(), all.end());
  struct Counted {
    std::size_t count;
    std::uint32_t pair;
  };
  std::vector<Counted> counted;
  for (std::size_t i = 0; i < all.size();) {
    std::size_t end = i;
    while (end < all.size() && all[end] == all[i]) ++end;
    counted.push_back({end - i, all[i]});
    i = end;
  }
  std::stable_sort(counted.begin(), counted.end(), [](const Counted& a, const Counted& b) {
    return a.count > b.count;
  });
  std::vector<Pair> pairs;
  for (const Counted& c : counted) {
    const Pair pair{static_cast<std::uint16_t>(c.pair >> 16U),
                    static_cast<std::uint16_t>(c.pair & 0xffffU)};
    const bool used = std::any_of(pairs.begin(), pairs.end(), [&](const Pair& p) {
      return p.model == pair.model || p.image == pair.image;
    });
    if (!used) pairs.push_back(pair);
  }
  return pairs;
}

struct Bin {
  std::size_t features, first, end;
};

// The fullest bins, of each model its share: one that looks like everything leaves room for others.
std::vector<Bin> full_bins(std::span<const Vote> votes,
                           const QuadIndex& index,
                           std::size_t models) {
  std::vector<Bin> bins;
  std::vector<std::uint16_t> features;
  for (std::size_t i = 0; i < votes.size();) {
    std::size_t end = i;
    features.clear();
    while (end < votes.size() && votes[end].bin == votes[i].bin) {
      for (const std::uint16_t id : index.quads()[votes[end].model_quad].ids)
        features.push_back(id);
      ++end;
    }
    if (end - i > 1) {
      std::sort(features.begin(), features.end());
      const std::size_t distinct = static_cast<std::size_t>(
          std::unique(features.begin(), features.end()) - features.begin());
      if (distinct >= kFeaturesOfABin) bins.push_back({distinct, i, end});
    }
    i = end;
  }
  std::stable_sort(
      bins.begin(), bins.end(), [](const Bin& a, const Bin& b) { return a.features > b.features; });
  const std::size_t share = std::max(kLeastBins, kMostBins / models);
  std::vector<std::size_t> kept(models, 0);
  std::erase_if(bins, [&](const Bin& bin) {
    return ++kept[index.quads()[votes[bin.first].model_quad].model] > share;
  });
  return bins;
}

}  // namespace

bool search_by_votes(std::span<const SearchModel> models,
                     const QuadIndex& index,
                     const ImageView& image,
                     std::span<const ImageQuad> quads,
                     const VoteOptions& options,
                     const RunContext& run,
                     CandidatePool& pool) {
  constexpr std::size_t kCheckEvery = 256;
  Ballot ballot(index, image, options);
  for (std::size_t i = 0; i < quads.size(); ++i)
    ballot.add(quads[i], static_cast<std::uint32_t>(i));
  ballot.vote(quads, run);
  std::vector<Vote>& votes = ballot.votes();
  std::vector<Vote> shared;  // with others in their bin, or in one of the same counter
  for (const Vote& vote : votes) {
    if (ballot.count(vote.bin) > 1) shared.push_back(vote);
  }
  std::stable_sort(
      shared.begin(), shared.end(), [](const Vote& a, const Vote& b) { return a.bin < b.bin; });
  for (const Bin& bin : full_bins(shared, index, models.size())) {
    run.check("verify");
    const std::span<const Vote> of_bin = std::span(shared).subspan(bin.first, bin.end - bin.first);
    const std::vector<Pair> pairs = pairs_of(of_bin, index, quads);
    if (pairs.size() >= 4) {
      try_pairs(models, image, index.quads()[of_bin.front().model_quad].model, pairs, pool);
    }
  }
  if (pool.beyond_doubt()) return !ballot.is_full();
  // Single votes: those with company first, then those whose code is nearest.
  std::array<std::vector<std::uint32_t>, 32> order;
  for (std::uint32_t i = 0; i < votes.size(); ++i) {
    const unsigned company = std::min(3U, ballot.count(votes[i].bin) - 1U);
    order[(3U - company) * 8U + votes[i].miss].push_back(i);
  }
  std::size_t tried = 0;
  for (const std::vector<std::uint32_t>& level : order) {
    for (const std::uint32_t i : level) {
      if (tried == options.most_singles) return false;
      if (tried % kCheckEvery == 0) {
        run.check("verify");
        if (pool.beyond_doubt()) return !ballot.is_full();
      }
      ++tried;
      const Vote& vote = votes[i];
      const std::array<std::uint16_t, 4> ids =
          ordered(quads[vote.image_quad >> 2U], vote.image_quad & 3U);
      const ModelQuad& hit = index.quads()[vote.model_quad];
      std::array<Pair, 4> pairs;
      for (std::size_t k = 0; k < 4; ++k) pairs[k] = {hit.ids[k], ids[k]};
      try_pairs(models, image, hit.model, pairs, pool);
    }
  }
  return !ballot.is_full();
}

}  // namespace landmarkdb
