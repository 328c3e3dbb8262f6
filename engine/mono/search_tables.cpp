#include "engine/mono/search_tables.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "engine/mono/model_triples.hpp"
#include "engine/mono/outline_places.hpp"
#include "engine/mono/search_model.hpp"
#include "engine/mono/visibility.hpp"

namespace landmarkdb {
namespace {

// Raised whenever the same numbers lead to another choice, or the bytes mean something else.
constexpr std::int64_t kVersion = 1;
constexpr double kLookalikeShare = 0.4;  // of the points: fewer make no rival
constexpr std::size_t kMostLookalikes = 48;

constexpr std::size_t kMaskBytes = kModelViews / 8;
constexpr std::size_t kLeastQuadBytes = 10;
constexpr std::size_t kMotionBytes = 16 * sizeof(double);
static_assert(kModelViews <= 256, "a view's number takes a byte");

class Writer {
 public:
  void number(std::uint64_t value, unsigned bytes) {
    for (unsigned i = 0; i < bytes; ++i) {
      bytes_.push_back(static_cast<std::byte>((value >> (8 * i)) & 0xffU));
    }
  }
  void mask(const ViewMask& views) {
    for (std::size_t word = 0; word < kModelViews / 64; ++word) {
      number(((views >> (64 * word)) & ViewMask(~std::uint64_t{0})).to_ullong(), 8);
    }
  }
  void quad(const ChosenQuad& quad) {
    for (const std::uint16_t id : quad.ids) number(id, 2);
    number(quad.views.count() - 1, 1);
    for (std::size_t view = 0; view < kModelViews; ++view) {
      if (quad.views[view]) number(view, 1);
    }
  }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

// Reads on. Past the end all is zero, and `ended` says so.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  std::size_t left() const { return bytes_.size() - at_; }
  bool ended() const { return ended_; }

  std::uint64_t number(unsigned bytes) {
    if (left() < bytes) {
      ended_ = true;
      at_ = bytes_.size();
      return 0;
    }
    std::uint64_t value = 0;
    for (unsigned i = 0; i < bytes; ++i) {
      value |= static_cast<std::uint64_t>(bytes_[at_++]) << (8 * i);
    }
    return value;
  }
  ViewMask mask() {
    ViewMask views;
    for (std::size_t word = 0; word < kModelViews / 64; ++word) {
      views |= ViewMask(number(8)) << (64 * word);
    }
    return views;
  }
  void skip_quad() {
    at_ += std::min(left(), kLeastQuadBytes - 2);
    const std::uint64_t views = number(1) + 1;
    ended_ = ended_ || left() < views;
    at_ += std::min<std::size_t>(left(), views);
  }
  ChosenQuad quad() {
    ChosenQuad quad;
    for (std::uint16_t& id : quad.ids) id = static_cast<std::uint16_t>(number(2));
    const std::uint64_t views = number(1) + 1;
    for (std::uint64_t i = 0; i < views; ++i) quad.views.set(number(1));
    return quad;
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  bool ended_ = false;
};

bool is_rigid(const Eigen::Matrix4d& T) {
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  return T.allFinite() && R.isUnitary(1e-6) && R.determinant() > 0.0 &&
         T.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1));
}

// Four different points of the model, each seen in all of the quad's views.
bool fits(const ChosenQuad& quad, const std::vector<ViewMask>& seen) {
  for (std::size_t k = 0; k < 4; ++k) {
    if (quad.ids[k] >= seen.size() || (k > 0 && quad.ids[k] <= quad.ids[k - 1])) return false;
    if ((quad.views & ~seen[quad.ids[k]]).any()) return false;
  }
  return true;
}

}  // namespace

MonoModel mirror_image(const MonoModel& model) {
  const auto reflect = [](Eigen::Vector3d& v) { v.x() = -v.x(); };
  MonoModel mirror = model;
  for (ModelFeature& point : mirror.points) {
    reflect(point.xyz);
    if (point.normal) reflect(*point.normal);
  }
  for (ModelCircle& circle : mirror.circles) {
    reflect(circle.center);
    reflect(circle.normal);
  }
  for (std::vector<std::uint32_t>& face : mirror.faces) std::reverse(face.begin(), face.end());
  return mirror;
}

SearchTables make_search_tables(const MonoModel& model, const RunContext& context, QuadUse quads) {
  SearchTables tables;
  tables.seen = views_of_points(model, "index", context);
  tables.mirror_seen = views_of_points(mirror_image(model), "index", context);
  if (quads == QuadUse::kWanted) tables.quads = choose_quads(model, tables.seen);
  tables.outline_seen = views_of_outline(model, context);
  tables.lookalikes = find_lookalikes(model, kLookalikeShare, kMostLookalikes);
  return tables;
}

ModelIndexBlob model_index_format() {
  return {kVersion, quad_choice_params() + " lookalikes=" + std::to_string(kMostLookalikes), {}};
}

ModelIndexBlob make_model_index(const MonoModel& model, const RunContext& context) {
  const SearchTables tables = make_search_tables(model, context);
  Writer writer;
  for (const std::size_t count : {tables.seen.size(),
                                  tables.outline_seen.size(),
                                  tables.quads.size(),
                                  tables.lookalikes.size()}) {
    writer.number(count, 4);
  }
  for (const auto* masks : {&tables.seen, &tables.mirror_seen, &tables.outline_seen}) {
    for (const ViewMask& views : *masks) writer.mask(views);
  }
  for (const ChosenQuad& quad : tables.quads) writer.quad(quad);
  for (const Eigen::Isometry3d& motion : tables.lookalikes) {
    for (Eigen::Index i = 0; i < 16; ++i) {
      writer.number(std::bit_cast<std::uint64_t>(motion.matrix()(i / 4, i % 4)), 8);
    }
  }
  ModelIndexBlob index = model_index_format();
  index.quads = writer.take();
  return index;
}

std::optional<SearchTables> read_model_index(const ModelIndexBlob& index,
                                             const MonoModel& model,
                                             QuadUse use) {
  if (!index.is_made_like(model_index_format())) return std::nullopt;
  Reader reader(index.quads);
  const std::uint64_t points = reader.number(4), places = reader.number(4);
  const std::uint64_t quads = reader.number(4), motions = reader.number(4);
  // Each count is below 2^32 and each row below 2^8 bytes: no overflow.
  if (points != model.points.size() || places != outline_places(model).size() ||
      reader.left() <
          (2 * points + places) * kMaskBytes + quads * kLeastQuadBytes + motions * kMotionBytes) {
    return std::nullopt;
  }
  SearchTables tables;
  for (std::uint64_t i = 0; i < points; ++i) tables.seen.push_back(reader.mask());
  for (std::uint64_t i = 0; i < points; ++i) tables.mirror_seen.push_back(reader.mask());
  for (std::uint64_t i = 0; i < places; ++i) tables.outline_seen.push_back(reader.mask());
  if (use == QuadUse::kWanted) tables.quads.reserve(quads);
  for (std::uint64_t i = 0; i < quads; ++i) {
    if (use == QuadUse::kLeftOut) {
      reader.skip_quad();
      continue;
    }
    tables.quads.push_back(reader.quad());
    if (!fits(tables.quads.back(), tables.seen)) return std::nullopt;
  }
  for (std::uint64_t i = 0; i < motions; ++i) {
    Eigen::Isometry3d motion;
    for (Eigen::Index k = 0; k < 16; ++k) {
      motion.matrix()(k / 4, k % 4) = std::bit_cast<double>(reader.number(8));
    }
    if (!is_rigid(motion.matrix())) return std::nullopt;
    tables.lookalikes.push_back(motion);
  }
  if (reader.ended() || reader.left() > 0) return std::nullopt;
  return tables;
}

std::vector<ChosenQuad> read_quads(const MonoModelRecord& record, const RunContext& context) {
  if (record.index) {
    if (std::optional<SearchTables> tables = read_model_index(*record.index, record.model)) {
      return std::move(tables->quads);
    }
  }
  return choose_quads(record.model, views_of_points(record.model, "index", context));
}

MonoModelRecord derive_record(MonoModel model, const RunContext& context) {
  MonoModelRecord record{std::move(model)};
  record.triples = make_triples(record.model, context);
  record.index = make_model_index(record.model, context);
  return record;
}

}  // namespace landmarkdb
