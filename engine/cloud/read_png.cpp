#include "engine/cloud/read_png.hpp"

#include <bit>
#include <csetjmp>
#include <cstddef>
#include <cstring>
#include <string>

#include <png.h>

#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

// What libpng's callbacks see. It reports errors by longjmp, over whose frames nothing with a
// destructor may live: all memory belongs to the caller.
struct PngSource {
  std::span<const std::byte> bytes;
  std::size_t at = 0;
  char message[128] = {};
};

extern "C" {

void read_from_source(png_structp png, png_bytep out, std::size_t count) {
  auto* source = static_cast<PngSource*>(png_get_io_ptr(png));
  if (source->bytes.size() - source->at < count) png_error(png, "the file ends early");
  std::memcpy(out, source->bytes.data() + source->at, count);
  source->at += count;
}

void keep_error(png_structp png, png_const_charp message) {
  auto* source = static_cast<PngSource*>(png_get_error_ptr(png));
  std::strncpy(source->message, message, sizeof(source->message) - 1);
  png_longjmp(png, 1);
}

void ignore_warning(png_structp, png_const_charp) {}

}  // extern "C"

struct PngHandles {
  png_structp png = nullptr;
  png_infop info = nullptr;
  ~PngHandles() { png_destroy_read_struct(&png, &info, nullptr); }
};

// The functions below return false on an error; its text is then in the source. No object with a
// destructor in them.

bool read_header(PngHandles& handles, PngSource& source, PngHeader& header) {
  if (setjmp(png_jmpbuf(handles.png)) != 0) return false;
  png_set_read_fn(handles.png, &source, read_from_source);
  png_read_info(handles.png, handles.info);
  header.width = png_get_image_width(handles.png, handles.info);
  header.height = png_get_image_height(handles.png, handles.info);
  header.bits = png_get_bit_depth(handles.png, handles.info);
  header.grey = png_get_color_type(handles.png, handles.info) == PNG_COLOR_TYPE_GRAY;
  return true;
}

bool read_rows16(PngHandles& handles, png_bytepp rows) {
  if (setjmp(png_jmpbuf(handles.png)) != 0) return false;
  if constexpr (std::endian::native == std::endian::little) png_set_swap(handles.png);
  png_set_interlace_handling(handles.png);
  png_read_update_info(handles.png, handles.info);
  png_read_image(handles.png, rows);
  png_read_end(handles.png, nullptr);
  return true;
}

struct Layout {
  int passes = 1;  // 7 where interlaced
  std::size_t channels = 1;
};

bool ask_for_8_bits(PngHandles& handles, Layout& layout) {
  if (setjmp(png_jmpbuf(handles.png)) != 0) return false;
  png_set_expand(handles.png);
  png_set_scale_16(handles.png);
  png_set_strip_alpha(handles.png);
  layout.passes = png_set_interlace_handling(handles.png);
  png_read_update_info(handles.png, handles.info);
  layout.channels = png_get_channels(handles.png, handles.info);
  return true;
}

void to_luma(const std::uint8_t* rgb, std::size_t count, std::uint8_t* grey) {
  for (std::size_t i = 0; i < count; ++i, rgb += 3) grey[i] = luma_of(rgb[0], rgb[1], rgb[2]);
}

// `row` holds one row of colours, or all of them where the picture comes in passes; unused where
// the file is grey.
bool read_rows8(PngHandles& handles,
                const PngHeader& header,
                const Layout& layout,
                std::uint8_t* grey,
                std::uint8_t* row) {
  if (setjmp(png_jmpbuf(handles.png)) != 0) return false;
  const std::size_t width = header.width;
  const std::size_t pitch = layout.passes > 1 ? width * layout.channels : 0;
  for (int pass = 0; pass < layout.passes; ++pass) {
    for (std::size_t v = 0; v < header.height; ++v) {
      std::uint8_t* out = layout.channels == 1 ? grey + v * width : row + v * pitch;
      png_read_row(handles.png, out, nullptr);
      if (layout.channels > 1 && pass == layout.passes - 1) to_luma(out, width, grey + v * width);
    }
  }
  png_read_end(handles.png, nullptr);
  return true;
}

}  // namespace

class PngReader::Impl {
 public:
  explicit Impl(const Input& from) : input(from), source{from.bytes} {
    handles.png =
        png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, keep_error, ignore_warning);
    if (handles.png != nullptr) handles.info = png_create_info_struct(handles.png);
    if (handles.info == nullptr) {
      throw Error(ErrorCode::kResourceExhausted, "no memory for the PNG reader");
    }
    if (!read_header(handles, source, header)) {
      refuse(input, "no PNG that can be read: " + std::string(source.message));
    }
  }

  [[noreturn]] void refuse_damage() const {
    refuse(input, "a damaged PNG: " + std::string(source.message));
  }

  std::size_t pixels() const { return std::size_t{header.width} * header.height; }

  Input input;
  PngSource source;
  PngHandles handles;
  PngHeader header;
};

PngReader::PngReader(const Input& input) : impl_(std::make_unique<Impl>(input)) {}
PngReader::~PngReader() = default;

const PngHeader& PngReader::header() const { return impl_->header; }

// A header may lie; deflate (RFC 1951) packs at most 1032 bytes into one.
void PngReader::check_promise() const {
  constexpr std::size_t kDensest = 1032;
  const std::size_t row_bytes = png_get_rowbytes(impl_->handles.png, impl_->handles.info);
  const std::size_t most = impl_->input.bytes.size() * kDensest;
  if (impl_->header.height > most / row_bytes) {
    refuse(impl_->input,
           "the header promises " + std::to_string(impl_->header.width) + " x " +
               std::to_string(impl_->header.height) + " pixels, but the file has only " +
               std::to_string(impl_->input.bytes.size()) + " bytes");
  }
}

std::vector<std::uint16_t> PngReader::read_grey16() {
  check_promise();
  std::vector<std::uint16_t> values(impl_->pixels());
  std::vector<png_bytep> rows(impl_->header.height);
  for (std::size_t v = 0; v < rows.size(); ++v) {
    rows[v] = reinterpret_cast<png_bytep>(values.data() + v * impl_->header.width);
  }
  if (!read_rows16(impl_->handles, rows.data())) impl_->refuse_damage();
  return values;
}

std::vector<std::uint8_t> PngReader::read_grey8() {
  check_promise();
  Layout layout;
  if (!ask_for_8_bits(impl_->handles, layout)) impl_->refuse_damage();
  std::vector<std::uint8_t> grey(impl_->pixels());
  std::vector<std::uint8_t> colours;
  if (layout.channels > 1) {
    const std::size_t rows = layout.passes > 1 ? impl_->header.height : 1;
    colours.resize(rows * impl_->header.width * layout.channels);
  }
  if (!read_rows8(impl_->handles, impl_->header, layout, grey.data(), colours.data())) {
    impl_->refuse_damage();
  }
  return grey;
}

}  // namespace landmarkdb
