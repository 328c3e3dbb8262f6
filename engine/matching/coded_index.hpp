#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "engine/matching/descriptor_index.hpp"
#include "engine/types/descriptor_codes.hpp"

namespace landmarkdb {

// The descriptors of one entry and their codes (make_codes.hpp).
struct CodedPart {
  // N x kShotLength, unit length; must outlive the index. Empty: the codes alone are at hand.
  std::span<const float> values;
  const DescriptorCodes* codes = nullptr;  // copied
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
};

// Ranks by l2 distance. Finds most of the true neighbours; what it returns was compared in full. In
// an index with parts of which only the codes are at hand nothing is: there the distance is that of
// code and tail, a little less than the true one, the order that of the codes, and no descriptors
// need to be kept.
// Rows count on through the parts in their order. The same bytes on every machine. Takes 136 bytes
// a row beside the parts. Throws Error{kInvalidArgument} for codes that do not fit their values.
std::unique_ptr<DescriptorIndex> make_coded_index(std::span<const CodedPart> parts,
                                                  const CodedSearchOptions& options = {});

}  // namespace landmarkdb
