#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "engine/base/run_context.hpp"
#include "engine/mono/choose_quads.hpp"
#include "engine/types/mono_model.hpp"

namespace landmarkdb {

// What a search needs of a model and takes long to work out: kept in the database beside it.
struct SearchTables {
  std::vector<ViewMask> seen;         // of each point, the views that see it
  std::vector<ViewMask> mirror_seen;  // the same of the model's mirror image (mirror_rival.hpp)
  std::vector<ChosenQuad> quads;
  std::vector<ViewMask> outline_seen;  // of each of outline_places(), the views that see it
  // Rigid motions that carry many points onto points, but not all: poses that a search may take for
  // each other (the next place of a grid). Most points first.
  std::vector<Eigen::Isometry3d> lookalikes;
};

// Most models are looked up by their linked fours and need no quads, which are most of the bytes.
enum class QuadUse { kWanted, kLeftOut };

// Throws what `context.check` does.
SearchTables make_search_tables(const MonoModel& model,
                                const RunContext& context = {},
                                QuadUse quads = QuadUse::kWanted);

// The tables as bytes, little-endian: the counts of points, outline places, quads and lookalikes as
// 32-bit numbers; 32 bytes of views a point, twice, and a place, bit k % 8 of byte k / 8 for view
// k; of each quad four 16-bit ids, the number of its views less one, and these, a byte each,
// ascending; 16 doubles, row by row, a lookalike.
ModelIndexBlob make_model_index(const MonoModel& model, const RunContext& context = {});

// What tells whether a stored index is of this program's making: its version and params, no bytes.
ModelIndexBlob model_index_format();

// Nothing where the bytes are of another version or other params, or do not fit the model: they are
// then made anew.
std::optional<SearchTables> read_model_index(const ModelIndexBlob& index,
                                             const MonoModel& model,
                                             QuadUse quads = QuadUse::kWanted);

// The quads alone, from the record's own index where it has one that fits.
std::vector<ChosenQuad> read_quads(const MonoModelRecord& record, const RunContext& context = {});

// A record with all that is derived from its model: triples and index.
MonoModelRecord derive_record(MonoModel model, const RunContext& context = {});

// The reflection of a model at x = 0, with its faces turned outward again.
MonoModel mirror_image(const MonoModel& model);

}  // namespace landmarkdb
