#include "engine/mono/edge_wishes.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <span>

namespace landmarkdb {
namespace {

constexpr std::int32_t kReach = 2;  // pixels
constexpr std::size_t kAcross = 2 * kReach + 1;

// Eight bytes as they lie, the first one lowest.
std::uint64_t in_order(std::uint64_t eight) {
  return std::endian::native == std::endian::big ? __builtin_bswap64(eight) : eight;
}

// The points of one row by column.
class RowRanks {
 public:
  explicit RowRanks(std::size_t width)
      : flags_((width + 2 * kReach + 1) / kBlock * kBlock + kBlock, 0),
        before_(flags_),
        firsts_(flags_.size() / kBlock, 0) {}

  void fill(const EdgeMap& map, std::size_t y) {
    constexpr std::uint64_t kOnes = 0x0101010101010101;
    const std::uint32_t begin = map.row_starts[y], end = map.row_starts[y + 1];
    for (std::uint32_t i = begin; i < end; ++i) flags_[place_of(map.columns[i])] = 1;
    std::uint32_t first = begin;
    for (std::size_t block = 0; block < firsts_.size(); ++block) {
      std::uint64_t eight = 0;
      std::memcpy(&eight, &flags_[block * kBlock], sizeof eight);
      const std::uint64_t up_to = in_order(eight) * kOnes;  // byte k: of flags 0 to k
      const std::uint64_t before = in_order(up_to << 8U);
      std::memcpy(&before_[block * kBlock], &before, sizeof before);
      firsts_[block] = first;
      first += static_cast<std::uint32_t>(up_to >> 56U);
    }
    for (std::uint32_t i = begin; i < end; ++i) flags_[place_of(map.columns[i])] = 0;
  }

  // The first point that is not left of a column, from -kReach to width + kReach.
  std::uint32_t first_from(std::int32_t column) const {
    const std::size_t place = place_of(column);
    return firsts_[place / kBlock] + before_[place];
  }

 private:
  static constexpr std::size_t kBlock = sizeof(std::uint64_t);
  static std::size_t place_of(std::int32_t column) {
    return static_cast<std::size_t>(column + kReach);
  }

  std::vector<std::uint8_t> flags_, before_;  // before: points in the same block, left of it
  std::vector<std::uint32_t> firsts_;         // of each block
};

// Four numbers at once, which every machine does alike.
constexpr std::size_t kLanes = 4;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef std::int32_t Ints __attribute__((vector_size(kLanes * sizeof(std::int32_t))));

Ints bits_of(Floats v) {
  Ints bits;
  std::memcpy(&bits, &v, sizeof bits);
  return bits;
}

// Pairs of points, each once: of the upper row, or left in one row, and of the lower.
class Pairs {
 public:
  // Makes room for the pairs of one row.
  void restart(std::size_t points) {
    constexpr std::size_t kMost = kReach * (1 + kAcross);  // of a point
    const std::size_t room = points * kMost + kAcross + 2 * kLanes;
    if (upper_.size() < room) {
      upper_.resize(room);
      lower_.resize(room);
    }
    size_ = 0;
  }

  // Adds the pairs of a point with points [first, end), `most` or fewer. Always `most` and more are
  // written, the others to be written over: how many there are is as good as chance.
  template <std::size_t most>
  void add(std::uint32_t point, std::uint32_t first, std::uint32_t end) {
    const Ints upper = Ints{} + static_cast<std::int32_t>(point);
    Ints lower = Ints{0, 1, 2, 3} + static_cast<std::int32_t>(first);
    for (std::size_t at = 0; at < most; at += kLanes) {
      std::memcpy(&upper_[size_ + at], &upper, sizeof upper);
      std::memcpy(&lower_[size_ + at], &lower, sizeof lower);
      lower += static_cast<std::int32_t>(kLanes);
    }
    size_ += end - first;
  }

  // Fills up to whole lanes with a point and itself, of which no link comes.
  void fill_up() {
    if (size_ == 0) return;
    std::fill_n(&lower_[size_], kLanes, upper_[0]);
    std::fill_n(&upper_[size_], kLanes, upper_[0]);
  }

  std::size_t size() const { return size_; }
  const std::uint32_t* upper() const { return upper_.data(); }
  const std::uint32_t* lower() const { return lower_.data(); }

 private:
  std::vector<std::uint32_t> upper_, lower_;
  std::size_t size_ = 0;
};

struct Points {
  Floats u, v, nx, ny;
};

Points gather(const EdgePoint* points, const std::uint32_t* indices) {
  static_assert(sizeof(EdgePoint) == sizeof(Floats));
  Floats p[kLanes];
  for (std::size_t i = 0; i < kLanes; ++i) std::memcpy(&p[i], points + indices[i], sizeof p[i]);
  const Floats uv_ab = __builtin_shufflevector(p[0], p[1], 0, 4, 1, 5);
  const Floats uv_cd = __builtin_shufflevector(p[2], p[3], 0, 4, 1, 5);
  const Floats n_ab = __builtin_shufflevector(p[0], p[1], 2, 6, 3, 7);
  const Floats n_cd = __builtin_shufflevector(p[2], p[3], 2, 6, 3, 7);
  return {__builtin_shufflevector(uv_ab, uv_cd, 0, 1, 4, 5),
          __builtin_shufflevector(uv_ab, uv_cd, 2, 3, 6, 7),
          __builtin_shufflevector(n_ab, n_cd, 0, 1, 4, 5),
          __builtin_shufflevector(n_ab, n_cd, 2, 3, 6, 7)};
}

// What points `who` think of a link to `others`, which lie (du, dv) away.
struct Opinions {
  LinkWish wishes[kLanes];
  std::uint32_t ways[kLanes];  // 2 * who, and 1 for behind

  void form(const Points& p,
            Floats du,
            Floats dv,
            Ints turns,
            const std::uint32_t* who,
            const std::uint32_t* others) {
    constexpr float kLeastStep = 0.2F;  // below, the two are side by side
    const Floats along = -p.ny * du + p.nx * dv;
    const Floats aside = p.nx * du + p.ny * dv;
    const Ints none = turns | ((along <= kLeastStep) & (along >= -kLeastStep));
    const Ints cost = bits_of(along * along + 2.0F * aside * aside) | none;
    Ints other, way;
    std::memcpy(&other, others, sizeof other);
    std::memcpy(&way, who, sizeof way);
    other |= none;
    way = 2 * way - (along < 0.0F);
    std::memcpy(ways, &way, sizeof way);
    const bool big = std::endian::native == std::endian::big;
    const Ints first = big ? cost : other, second = big ? other : cost;
    const Ints low = __builtin_shufflevector(first, second, 0, 4, 1, 5);
    const Ints high = __builtin_shufflevector(first, second, 2, 6, 3, 7);
    std::memcpy(wishes, &low, sizeof low);
    std::memcpy(wishes + kLanes / 2, &high, sizeof high);
  }
};

void consider(const EdgePoint* points, const Pairs& pairs, LinkWish* ways) {
  for (std::size_t at = 0; at < pairs.size(); at += kLanes) {
    const std::uint32_t *upper = pairs.upper() + at, *lower = pairs.lower() + at;
    const Points p = gather(points, upper), q = gather(points, lower);
    const Ints turns = p.nx * q.nx + p.ny * q.ny < kLeastLinkCosine;
    const Floats du = q.u - p.u, dv = q.v - p.v;
    Opinions of_p, of_q;
    of_p.form(p, du, dv, turns, upper, lower);
    of_q.form(q, -du, -dv, turns, lower, upper);
    for (const Opinions* of : {&of_p, &of_q}) {
      for (std::size_t i = 0; i < kLanes; ++i)
        ways[of->ways[i]] = std::min(ways[of->ways[i]], of->wishes[i]);
    }
  }
}

std::size_t width_of(const EdgeMap& map) {
  const auto last = std::max_element(map.columns.begin(), map.columns.end());
  return last == map.columns.end() ? 0 : static_cast<std::size_t>(*last) + 1;
}

// The pairs of row y's points with those right of them and in the rows below.
void find_pairs(const EdgeMap& map,
                std::size_t y,
                const RowRanks& row,
                std::span<const RowRanks* const> below,
                Pairs& pairs) {
  pairs.restart(map.row_starts[y + 1] - map.row_starts[y]);
  for (std::uint32_t i = map.row_starts[y]; i < map.row_starts[y + 1]; ++i) {
    const std::int32_t left = map.columns[i] - kReach, past = map.columns[i] + kReach + 1;
    pairs.add<kReach>(i, i + 1, row.first_from(past));
    for (const RowRanks* other : below)
      pairs.add<kAcross>(i, other->first_from(left), other->first_from(past));
  }
  pairs.fill_up();
}

}  // namespace

std::vector<LinkWishes> find_link_wishes(const EdgeMap& map, const RunContext& run) {
  std::vector<LinkWishes> wishes(map.points.size());
  if (wishes.empty()) return wishes;
  const std::size_t height = map.row_starts.size() - 1;
  std::vector<RowRanks> rows(kReach + 1, RowRanks(width_of(map)));
  std::size_t filled = 0;
  Pairs pairs;
  for (std::size_t y = 0; y < height; ++y) {
    constexpr std::size_t kRowsBetweenChecks = 64;
    if (y % kRowsBetweenChecks == 0) run.check("features");
    for (; filled < std::min(height, y + kReach + 1); ++filled)
      rows[filled % rows.size()].fill(map, filled);
    std::array<const RowRanks*, kReach> below{};
    for (std::size_t k = 0; k < kReach; ++k) below[k] = &rows[(y + k + 1) % rows.size()];
    find_pairs(map,
               y,
               rows[y % rows.size()],
               std::span(below).first(std::min<std::size_t>(kReach, height - 1 - y)),
               pairs);
    consider(map.points.data(), pairs, wishes.front().ways.data());
  }
  return wishes;
}

}  // namespace landmarkdb
