#include "proto/framing.hpp"

namespace landmarkdb {

namespace {

// A buffer larger than this is given back once it is empty, so that one long message does not hold
// memory for the rest of the connection.
constexpr std::size_t kKeptBufferBytes = 256 * 1024;

std::size_t read_frame_header(std::string_view bytes) {
  std::size_t length = 0;
  for (std::size_t i = 0; i < kFrameHeaderBytes; ++i) {
    length = (length << 8U) | static_cast<unsigned char>(bytes[i]);
  }
  return length;
}

}  // namespace

void write_frame_header(std::size_t payload_bytes, char* out) {
  for (std::size_t i = 0; i < kFrameHeaderBytes; ++i) {
    out[i] = static_cast<char>((payload_bytes >> (8 * (kFrameHeaderBytes - 1 - i))) & 0xffU);
  }
}

std::string encode_frame(std::string_view payload) {
  std::string frame(kFrameHeaderBytes, '\0');
  frame.reserve(kFrameHeaderBytes + payload.size());
  write_frame_header(payload.size(), frame.data());
  frame.append(payload);
  return frame;
}

void FrameReader::feed(std::string_view bytes) {
  if (failed_ != FrameStatus::kNeedMore) return;  // nothing after a bad header is of use
  if (begin_ == buffer_.size()) {
    if (buffer_.capacity() > kKeptBufferBytes) {
      buffer_ = std::string();
    } else {
      buffer_.clear();
    }
    begin_ = 0;
  } else if (begin_ > 0) {
    buffer_.erase(0, begin_);
    begin_ = 0;
  }
  buffer_.append(bytes);
}

Frame FrameReader::next() {
  // The last frame has been used: what it filled is not kept while the other end is silent.
  if (begin_ == buffer_.size() && buffer_.capacity() > kKeptBufferBytes) {
    buffer_ = std::string();
    begin_ = 0;
  }
  Frame frame;
  frame.status = failed_;
  if (failed_ != FrameStatus::kNeedMore || buffered_bytes() < kFrameHeaderBytes) return frame;

  const std::string_view held = std::string_view(buffer_).substr(begin_);
  frame.announced_bytes = read_frame_header(held);
  if (frame.announced_bytes == 0) {
    frame.status = failed_ = FrameStatus::kEmpty;
  } else if (frame.announced_bytes > limit_bytes_) {
    frame.status = failed_ = FrameStatus::kTooLong;
  } else if (held.size() - kFrameHeaderBytes >= frame.announced_bytes) {
    frame.status = FrameStatus::kFrame;
    frame.payload = held.substr(kFrameHeaderBytes, frame.announced_bytes);
    begin_ += kFrameHeaderBytes + frame.announced_bytes;
  }
  return frame;
}

}  // namespace landmarkdb
