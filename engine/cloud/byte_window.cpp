#include "engine/cloud/byte_window.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "engine/base/run_context.hpp"
#include "engine/cloud/text_lines.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kUsual = 256;  // bytes of a line, or of a word and the blanks before it
// Without it a file of one line would be in memory whole.
constexpr std::size_t kLongest = std::size_t{16} << 20U;

std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// How much to look at where the next `seen` bytes do not have the end of a word or line.
std::size_t look_further(const ByteWindow& window, std::size_t seen) {
  if (seen > kLongest) {
    refuse(window.input(),
           "the text from byte " + std::to_string(window.at()) +
               " on has no word or line of at most " + std::to_string(kLongest) + " bytes");
  }
  return 2 * seen + kUsual;
}

}  // namespace

void ByteWindow::fill(std::size_t want) {
  const std::span<const std::byte> kept = view_.subspan(used_);
  const std::uint64_t start = at();
  const auto size = static_cast<std::size_t>(
      std::min<std::uint64_t>(std::max(want, input_.rest.window_bytes), end_ - start));
  if (size > buffer_.size) {
    FileBytes larger{std::make_unique_for_overwrite<std::byte[]>(size), size};
    std::copy(kept.begin(), kept.end(), larger.data.get());
    buffer_ = std::move(larger);
  } else {
    std::copy(kept.begin(), kept.end(), buffer_.data.get());  // forwards: it may overlap
  }
  if (input_.context != nullptr) input_.context->check("read");
  std::size_t filled = kept.size();
  while (filled < size) {
    // Readers tell how far they are, but not while they wait for more than a window.
    const bool waited = filled > kept.size();
    if (waited && input_.context != nullptr) input_.context->report("read", start, input_.size());
    const std::size_t piece = std::min(input_.rest.window_bytes, size - filled);
    const std::size_t got =
        input_.rest.file->read(start + filled, {buffer_.data.get() + filled, piece});
    filled += got;
    if (got < piece) {  // cut off since it was opened
      end_ = start + filled;
      break;
    }
  }
  view_ = buffer_.span().first(filled);
  view_at_ = start;
  used_ = 0;
}

std::string_view take_word(ByteWindow& window) {
  for (std::size_t want = kUsual;;) {
    const std::string_view all = as_text(window.ahead(want));
    std::string_view rest = all;
    const std::string_view word = take_word(rest);
    if (rest.empty() && window.left() > all.size()) {  // it may go on behind what is in memory
      want = look_further(window, all.size());
      continue;
    }
    window.skip(all.size() - rest.size());
    return word;
  }
}

bool LineWindow::next(std::string_view& line) {
  for (std::size_t want = kUsual;;) {
    const std::string_view all = as_text(window_.ahead(want));
    LineReader lines(all);
    if (!lines.next(line)) return false;
    // A line end that comes last may be the first half of "\r\n".
    if (lines.at() == all.size() && window_.left() > all.size()) {
      want = look_further(window_, all.size());
      continue;
    }
    window_.skip(lines.at());
    ++number_;
    // What Windows programs put before UTF-8 text.
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    if (number_ == 1 && line.starts_with(kByteOrderMark)) line.remove_prefix(kByteOrderMark.size());
    return true;
  }
}

}  // namespace landmarkdb
