#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "engine/matching/coded_part.hpp"
#include "engine/matching/descriptor_index.hpp"

namespace landmarkdb {

// What an index takes of one entry.
struct IndexedPart {
  // N x kShotLength, unit length; must outlive the index. Empty: the codes alone are at hand.
  std::span<const float> values;
  std::shared_ptr<const CodedPart> codes;
  std::span<const std::int8_t> tails;  // by row; copied where the index keeps tails
};

// How much of the stored descriptors a query looks at: the defaults find 98 % of the nearest ones
// of a depth frame's descriptors among a million (docs/performance.md).
struct CodedSearchOptions {
  double list_share = 1.0 / 16.0;  // of the lists, those whose codes are read ...
  std::size_t min_lists = 128;     // ... and at least so many
  // Rows of which the tails are read, and of these the ones that are compared in full: so many,
  // and so many more for each neighbour asked for.
  std::size_t refined = 256;
  double refined_a_neighbour = 8.0;
  std::size_t compared = 32;
  double compared_a_neighbour = 2.0;
  // Without them a row takes 80 bytes instead of 144, ranks are those of the codes alone, and
  // nothing is compared in full.
  bool keeps_tails = true;
};

// Of all rows the codes: many neighbours are asked for then, and what proposes a pose need not be
// the very nearest; with 4 and 8 tails read for each nothing else was found.
inline constexpr CodedSearchOptions kScanOptions{
    .list_share = 1.0, .refined = 32, .refined_a_neighbour = 2.0};

// Ranks by l2 distance. Finds most of the true neighbours; what it returns was compared in full. In
// an index with parts of which only the codes are at hand nothing is: there the distance is that of
// code and tail, a little less than the true one, the order that of the codes, and no descriptors
// need to be kept.
// Rows count on through the parts in their order. The same bytes on every machine.
class CodedIndex : public DescriptorIndex {
 public:
  // The nearest among the rows of these parts alone (by their order, ascending), of which all codes
  // are compared: what an index over just these parts with kScanOptions finds. `out` and
  // what is thrown as in search(); rows are those of the whole index.
  virtual void search_parts(std::span<const std::size_t> parts,
                            std::span<const float> queries,
                            std::size_t k,
                            std::vector<DescriptorMatch>& out,
                            const RunContext& context) const = 0;
  virtual bool has_tails() const = 0;
};

// Takes the parts one after another; their codes are not copied.
class CodedIndexMaker {
 public:
  // Room is made for the tails of so many rows, where they are kept.
  explicit CodedIndexMaker(const CodedSearchOptions& options, std::size_t rows = 0);
  CodedIndexMaker(CodedIndexMaker&&) = delete;
  ~CodedIndexMaker();

  // Throws Error{kInvalidArgument} for codes that do not fit their values, or lack the tails that
  // are kept.
  void add(const IndexedPart& part);
  // Once, after the last part.
  std::unique_ptr<CodedIndex> finish();

 private:
  class Index;
  std::unique_ptr<Index> index_;
};

// Of all of these parts. Throws what CodedIndexMaker::add does.
std::unique_ptr<CodedIndex> make_coded_index(std::span<const IndexedPart> parts,
                                             const CodedSearchOptions& options = {});

}  // namespace landmarkdb
