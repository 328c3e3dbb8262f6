#include "engine/mono/quad_index.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/base/parallel.hpp"
#include "engine/mono/choose_quads.hpp"

namespace landmarkdb {
namespace {

ModelQuad make_quad(const SearchModel& search,
                    std::uint32_t number,
                    std::size_t view,
                    const std::array<std::uint16_t, 4>& s,
                    const std::vector<Eigen::Vector2d>& at,
                    const QuadCode& code) {
  const MonoModel& model = search.model();
  ModelQuad quad;
  for (std::size_t k = 0; k < 4; ++k) {
    quad.ids[k] = s[code.order[k]];
    quad.signature = static_cast<std::uint8_t>(
        quad.signature | (static_cast<unsigned>(model.points[quad.ids[k]].type) << (2 * k)));
  }
  const Eigen::Vector2d AB = at[quad.ids[1]] - at[quad.ids[0]];
  quad.model = number;
  quad.view = static_cast<std::uint8_t>(view);
  quad.links =
      link_mask(quad.ids, [&](std::uint16_t a, std::uint16_t b) { return search.linked(a, b); });
  quad.code = code.code;
  quad.length_m = static_cast<float>(AB.norm());
  const Eigen::Vector2d origin =
      QuadFrame(at[quad.ids[0]], at[quad.ids[1]])(Eigen::Vector2d::Zero());
  quad.origin_x = static_cast<float>(origin.x());
  quad.origin_y = static_cast<float>(origin.y());
  quad.angle_rad = static_cast<float>(std::atan2(AB.y(), AB.x()));
  return quad;
}

}  // namespace

std::vector<ModelQuad> quads_of(const SearchModel& search,
                                std::uint32_t number,
                                std::span<const ChosenQuad> chosen) {
  const std::vector<ModelFeature>& points = search.model().points;
  std::array<std::vector<Eigen::Vector2d>, kModelViews> images;
  std::array<std::size_t, kModelViews + 1> next{};  // where the quads of each view go
  for (std::size_t view = 0; view < kModelViews; ++view) {
    const Eigen::Matrix<double, 2, 3> axes = image_axes(model_views()[view]);
    for (const ModelFeature& point : points) {
      images[view].push_back(axes * (point.xyz - search.center));
    }
  }
  for (const ChosenQuad& quad : chosen) {
    for (std::size_t view = 0; view < kModelViews; ++view) next[view + 1] += quad.views[view];
  }
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<ModelQuad> quads(next.back());
  for (const ChosenQuad& quad : chosen) {
    const std::array<std::uint16_t, 4>& s = quad.ids;
    for (std::size_t view = 0; view < kModelViews; ++view) {
      if (!quad.views[view]) continue;
      const std::vector<Eigen::Vector2d>& at = images[view];
      QuadCode code;
      ModelQuad& made = quads[next[view]++];
      if (code_quad({at[s[0]], at[s[1]], at[s[2]], at[s[3]]}, code)) {
        made = make_quad(search, number, view, s, at, code);
      }
    }
  }
  // One that has no code was not chosen here; an index from elsewhere may say so.
  std::erase_if(quads, [](const ModelQuad& quad) { return !(quad.length_m > 0.0F); });
  return quads;
}

QuadIndex::QuadIndex(std::span<const SearchModel> models,
                     const RunContext& context,
                     std::span<const char> wanted) {
  RunContext quiet = context;  // progress is told from the calling thread only
  quiet.progress = nullptr;
  std::vector<std::vector<ModelQuad>> parts(models.size());
  parallel_chunks(models.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      context.check("models");
      if (!wanted.empty() && wanted[i] == 0) continue;
      const std::uint32_t number = static_cast<std::uint32_t>(i);
      parts[i] = models[i].quads.empty()
                     ? quads_of(models[i], number, read_quads(*models[i].record, quiet))
                     : quads_of(models[i], number, models[i].quads);
    }
  });
  // Sorted by cell in two steps, each within what a cache holds: first by signature and the code's
  // first coordinate, then by the others. Within a cell the order of models and views stays.
  std::array<bool, 256> used{};
  for (const std::vector<ModelQuad>& part : parts) {
    for (const ModelQuad& quad : part) used[quad.signature] = true;
  }
  std::size_t blocks = 0;
  for (std::size_t s = 0; s < used.size(); ++s) {
    block_of_[s] = used[s] ? static_cast<std::int32_t>(blocks++) : -1;
  }
  const auto slab = [&](const ModelQuad& quad) {
    return static_cast<std::size_t>(block_of_[quad.signature]) * kCells + cell(quad.code[0]);
  };
  std::vector<std::uint32_t> slabs(blocks * kCells + 1, 0);
  for (const std::vector<ModelQuad>& part : parts) {
    for (const ModelQuad& quad : part) ++slabs[slab(quad) + 1];
  }
  std::partial_sum(slabs.begin(), slabs.end(), slabs.begin());
  quads_.resize(slabs.back());
  std::vector<std::uint32_t> next = slabs;
  for (std::vector<ModelQuad>& part : parts) {
    for (const ModelQuad& quad : part) quads_[next[slab(quad)]++] = quad;
    part = {};  // a thousand models have a gigabyte of quads: not twice
  }
  starts_.assign(blocks * (kBlock + 1), 0);
  parallel_chunks(blocks * kCells, context.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      context.check("models");
      sort_slab(i, slabs[i], slabs[i + 1]);
    }
  });
  for (std::size_t b = 0; b < blocks; ++b) {
    starts_[b * (kBlock + 1) + kBlock] = slabs[(b + 1) * kCells];
  }
}

void QuadIndex::sort_slab(std::size_t slab, std::uint32_t begin, std::uint32_t end) {
  constexpr std::size_t kSlab = kBlock / kCells;
  const std::vector<ModelQuad> quads(quads_.begin() + begin, quads_.begin() + end);
  const auto slot = [](const ModelQuad& quad) {
    return (cell(quad.code[1]) * kCells + cell(quad.code[2])) * kCells + cell(quad.code[3]);
  };
  std::array<std::uint32_t, kSlab + 1> next{};
  for (const ModelQuad& quad : quads) ++next[slot(quad) + 1];
  next[0] = begin;
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::copy_n(next.begin(),
              kSlab,
              starts_.begin() + static_cast<std::ptrdiff_t>(slab / kCells * (kBlock + 1) +
                                                            slab % kCells * kSlab));
  for (const ModelQuad& quad : quads) quads_[next[slot(quad)]++] = quad;
}

}  // namespace landmarkdb
