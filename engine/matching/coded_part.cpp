#include "engine/matching/coded_part.hpp"

#include <algorithm>
#include <string>

#include "engine/base/error.hpp"
#include "engine/matching/make_codes.hpp"

namespace landmarkdb {

namespace {

std::size_t count_of(const DescriptorCodes& codes, std::size_t list) {
  return codes.list_start[list + 1] - codes.list_start[list];
}

std::size_t groups_of(const DescriptorCodes& codes) {
  std::size_t groups = 0;
  for (std::size_t l = 0; l < codes.lists(); ++l) {
    groups += (count_of(codes, l) + kCodeGroup - 1) / kCodeGroup;
  }
  return groups;
}

}  // namespace

std::shared_ptr<const CodedPart> make_coded_part(const DescriptorCodes& codes, std::size_t rows) {
  const std::string fault = fault_of_codes(codes, rows);
  if (!fault.empty()) throw Error(ErrorCode::kInvalidArgument, "the index " + fault);
  auto part = std::make_shared<CodedPart>();
  part->rows = rows;
  const std::size_t groups = groups_of(codes);
  part->codes.reserve(groups);
  part->row_of.reserve(groups * kCodeGroup);
  for (std::size_t l = 0; l < codes.lists(); ++l) {
    const std::size_t first = codes.list_start[l];
    const std::size_t count = count_of(codes, l);
    if (count == 0) continue;
    part->list_start.push_back(static_cast<std::uint32_t>(part->codes.groups()));
    part->codes.append(std::span(codes.codes).subspan(first * kCodeLength, count * kCodeLength));
    const auto begin = codes.rows.begin() + static_cast<std::ptrdiff_t>(first);
    part->row_of.insert(part->row_of.end(), begin, begin + static_cast<std::ptrdiff_t>(count));
    part->row_of.resize(part->codes.bias.size(), CodedPart::kNoRow);
    const auto centre = std::span(codes.centres).subspan(l * kCodeLength, kCodeLength);
    part->centres.insert(part->centres.end(), centre.begin(), centre.end());
  }
  part->list_start.push_back(static_cast<std::uint32_t>(part->codes.groups()));
  return part;
}

std::vector<std::int8_t> tails_by_row(const DescriptorCodes& codes) {
  std::vector<std::int8_t> tails(codes.size() * kCodeLength);
  for (std::size_t place = 0; place < codes.size(); ++place) {
    std::copy_n(codes.tails.data() + place * kCodeLength,
                kCodeLength,
                tails.data() + codes.rows[place] * kCodeLength);
  }
  return tails;
}

}  // namespace landmarkdb
