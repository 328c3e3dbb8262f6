#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include <jerror.h>
#include <jpeglib.h>

#include "engine/base/error.hpp"
#include "engine/mono/image_formats.hpp"

namespace landmarkdb {
namespace {

// What libjpeg's callbacks see; `base` comes first, as libjpeg knows it by that. It reports errors
// by longjmp, over whose frames nothing with a destructor may live: all memory is the caller's.
struct JpegErrors {
  jpeg_error_mgr base{};
  std::jmp_buf back{};
  char message[JMSG_LENGTH_MAX] = {};
};

extern "C" {

void leave_with_message(j_common_ptr jpeg) {
  auto* errors = reinterpret_cast<JpegErrors*>(jpeg->err);
  jpeg->err->format_message(jpeg, errors->message);
  std::longjmp(errors->back, 1);
}

// A file that is cut short or damaged inside only warns, and its picture is filled with grey: that
// is an error here. Level -1 is a warning, 0 and above are traces.
void treat_warning_as_error(j_common_ptr jpeg, int level) {
  // Padding between segments, which some cameras write, harms nothing.
  if (level < 0 && jpeg->err->msg_code != JWRN_EXTRANEOUS_DATA) leave_with_message(jpeg);
}

// Progressive files may hold any number of scans over the whole picture in few bytes.
void limit_scans(j_common_ptr jpeg) {
  constexpr int kMostScans = 200;  // encoders write about ten
  if (reinterpret_cast<j_decompress_ptr>(jpeg)->input_scan_number <= kMostScans) return;
  auto* errors = reinterpret_cast<JpegErrors*>(jpeg->err);
  std::snprintf(errors->message, sizeof errors->message, "more than %d scans", kMostScans);
  std::longjmp(errors->back, 1);
}

}  // extern "C"

struct Jpeg {
  jpeg_decompress_struct state{};
  jpeg_progress_mgr progress{};
  JpegErrors errors{};

  Jpeg() {
    state.err = jpeg_std_error(&errors.base);
    errors.base.error_exit = leave_with_message;
    errors.base.emit_message = treat_warning_as_error;
    progress.progress_monitor = limit_scans;
  }
  Jpeg(const Jpeg&) = delete;
  Jpeg& operator=(const Jpeg&) = delete;
  ~Jpeg() { jpeg_destroy_decompress(&state); }
};

// The functions below return false on an error; its text is then in `jpeg.errors`. No object with a
// destructor in them.

bool read_header(Jpeg& jpeg, const Input& input) {
  if (setjmp(jpeg.errors.back) != 0) return false;
  jpeg_create_decompress(&jpeg.state);
  jpeg.state.progress = &jpeg.progress;
  jpeg_mem_src(&jpeg.state,
               reinterpret_cast<const unsigned char*>(input.bytes.data()),
               static_cast<unsigned long>(input.bytes.size()));
  jpeg_read_header(&jpeg.state, TRUE);
  jpeg.state.out_color_space = JCS_GRAYSCALE;  // the luma as stored; of RGB, the same weights
  return true;
}

bool read_rows(Jpeg& jpeg, std::uint8_t* pixels) {
  if (setjmp(jpeg.errors.back) != 0) return false;
  jpeg_start_decompress(&jpeg.state);
  while (jpeg.state.output_scanline < jpeg.state.output_height) {
    JSAMPROW row = pixels + std::size_t{jpeg.state.output_scanline} * jpeg.state.output_width;
    jpeg_read_scanlines(&jpeg.state, &row, 1);
  }
  jpeg_finish_decompress(&jpeg.state);
  return true;
}

}  // namespace

GreyImage parse_jpeg_image(const Input& input, std::uint64_t max_pixels) {
  Jpeg jpeg;
  if (!read_header(jpeg, input)) {
    refuse(input, "no JPEG that can be read: " + std::string(jpeg.errors.message));
  }
  GreyImage image{jpeg.state.image_width, jpeg.state.image_height};
  check_image_size(input, image.width, image.height, max_pixels);
  // A header may lie: one bit a block of 64 pixels is about the least a file can spend.
  constexpr std::uint64_t kDensest = 1024;
  const std::uint64_t count = std::uint64_t{image.width} * image.height;
  if (count / kDensest > input.bytes.size()) {
    refuse(input,
           "the header promises " + std::to_string(image.width) + " x " +
               std::to_string(image.height) + " pixels, but the file has only " +
               std::to_string(input.bytes.size()) + " bytes");
  }
  if (jpeg.state.jpeg_color_space != JCS_GRAYSCALE && jpeg.state.jpeg_color_space != JCS_YCbCr &&
      jpeg.state.jpeg_color_space != JCS_RGB) {
    refuse(input, "a JPEG of four inks or unknown colours, want grey, YCbCr or RGB");
  }
  image.pixels.resize(count);
  if (!read_rows(jpeg, image.pixels.data())) {
    refuse(input, "a damaged JPEG: " + std::string(jpeg.errors.message));
  }
  return image;
}

}  // namespace landmarkdb
