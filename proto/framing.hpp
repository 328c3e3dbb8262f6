#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace landmarkdb {

// A frame is the length of its payload, 4 bytes big-endian, and the payload: one Envelope in
// protobuf's binary form. These functions know bytes only, no socket and no message.

inline constexpr std::uint32_t kProtocolMajor = 1;
inline constexpr std::uint32_t kProtocolMinor = 0;

inline constexpr std::size_t kFrameHeaderBytes = 4;
// Before Hello is done a peer is a stranger: its frame may be no longer than this.
inline constexpr std::size_t kMaxHelloBytes = 16 * 1024;
inline constexpr std::size_t kDefaultMaxMessageBytes = std::size_t{64} * 1024 * 1024;
// Protobuf refuses to write or parse messages of 2 GiB and more; so do we, with room to spare.
inline constexpr std::size_t kLargestMessageBytes = std::size_t{2047} * 1024 * 1024;

// Puts the header of a frame whose payload has `payload_bytes` in front: writes 4 bytes to `out`.
// `payload_bytes` is at most kLargestMessageBytes.
void write_frame_header(std::size_t payload_bytes, char* out);

// The frame of `payload`.
std::string encode_frame(std::string_view payload);

enum class FrameStatus {
  kNeedMore,  // the frame is not complete yet
  kFrame,     // `payload` is a frame
  kTooLong,   // the header announces more than the limit: nothing after it can be trusted
  kEmpty,     // the header announces zero bytes: no message has none
};

struct Frame {
  FrameStatus status = FrameStatus::kNeedMore;
  std::string_view payload;         // of kFrame: valid until the next call on the reader
  std::size_t announced_bytes = 0;  // what the header says; 0 while there is no header
};

// Cuts a stream of bytes into frames.
//
// Memory follows what really arrived, never what a header announces. After kTooLong or kEmpty the
// stream is lost: every later next() says the same. Not thread-safe.
class FrameReader {
 public:
  explicit FrameReader(std::size_t limit_bytes) : limit_bytes_(limit_bytes) {}

  // Holds for all headers that next() has not yet seen.
  void set_limit(std::size_t limit_bytes) { limit_bytes_ = limit_bytes; }

  void feed(std::string_view bytes);

  // The next frame, if it is complete.
  Frame next();

  // Bytes held: part of a frame, or frames that next() has not handed out.
  std::size_t buffered_bytes() const { return buffer_.size() - begin_; }
  // True when bytes of an unfinished frame are held, so that a timer can tell slow from idle.
  bool in_frame() const { return buffered_bytes() > 0; }

 private:
  std::string buffer_;
  std::size_t begin_ = 0;  // of the first byte not handed out
  std::size_t limit_bytes_;
  FrameStatus failed_ = FrameStatus::kNeedMore;
};

}  // namespace landmarkdb
