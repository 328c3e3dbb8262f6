#include "engine/cloud/write_cloud.hpp"

#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <limits>
#include <locale>
#include <memory>
#include <sstream>
#include <string>

#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

// A file that is written in pieces; every failure is an Error, that of the last flush included.
class OutputFile {
 public:
  explicit OutputFile(const std::filesystem::path& path)
      : name_(path.string()), file_(std::fopen(name_.c_str(), "wb")) {
    if (!file_) fail("cannot be written");
  }

  void write(const std::string& bytes) {
    if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) {
      fail("cannot be written");
    }
  }

  void close() {
    if (std::fclose(file_.release()) != 0) fail("cannot be written");
  }

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  [[noreturn]] void fail(const std::string& what) const {
    const bool full = errno == ENOSPC || errno == EDQUOT || errno == EFBIG;
    throw Error(full ? ErrorCode::kResourceExhausted : ErrorCode::kInvalidArgument,
                name_ + ": " + what + ": " + std::strerror(errno));
  }

  std::string name_;
  std::unique_ptr<std::FILE, CloseFile> file_;
};

template <typename T>
void append(std::string& bytes, T value) {
  static_assert(std::endian::native == std::endian::little, "both formats are little-endian here");
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

struct Layout {
  bool doubles = false;  // an origin would not survive in float
  bool normals = false, colours = false, viewpoint_index = false;
};

Layout choose_layout(const PointCloud& cloud) {
  Layout layout;
  layout.doubles = !cloud.origin.isZero(0.0);
  layout.normals = !cloud.empty() && cloud.normals.size() == cloud.size();
  layout.colours = !cloud.empty() && cloud.colours.size() == cloud.size();
  layout.viewpoint_index =
      cloud.viewpoints.size() > 1 && !cloud.empty() && cloud.viewpoint_index.size() == cloud.size();
  return layout;
}

std::ostringstream header_stream() {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(std::numeric_limits<double>::max_digits10);
  return out;
}

std::string ply_header(const PointCloud& cloud, const Layout& layout) {
  std::ostringstream out = header_stream();
  out << "ply\nformat binary_little_endian 1.0\n";
  for (const Eigen::Vector3f& viewpoint : cloud.viewpoints) {
    const Eigen::Vector3d v = cloud.origin + viewpoint.cast<double>();
    out << "comment viewpoint " << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  }
  out << "element vertex " << cloud.size() << '\n';
  for (const char* axis : {"x", "y", "z"}) {
    out << "property " << (layout.doubles ? "double " : "float ") << axis << '\n';
  }
  if (layout.normals) out << "property float nx\nproperty float ny\nproperty float nz\n";
  if (layout.colours) out << "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (layout.viewpoint_index) out << "property ushort viewpoint\n";
  out << "end_header\n";
  return out.str();
}

// PCD has no place for several.
Eigen::Vector3d pcd_viewpoint(const PointCloud& cloud) {
  if (cloud.viewpoints.size() != 1) return Eigen::Vector3d::Zero();
  return cloud.origin + cloud.viewpoints[0].cast<double>();
}

std::string pcd_header(const PointCloud& cloud, const Layout& layout) {
  const bool organised =
      std::uint64_t{cloud.width} * cloud.height == cloud.size() && cloud.height > 1;
  const Eigen::Vector3d v = pcd_viewpoint(cloud);
  const char* size = layout.doubles ? " 8 8 8" : " 4 4 4";
  std::ostringstream out = header_stream();
  out << "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z"
      << (layout.normals ? " normal_x normal_y normal_z" : "") << (layout.colours ? " rgb" : "")
      << "\nSIZE" << size << (layout.normals ? " 4 4 4" : "") << (layout.colours ? " 4" : "")
      << "\nTYPE F F F" << (layout.normals ? " F F F" : "") << (layout.colours ? " U" : "")
      << "\nCOUNT 1 1 1" << (layout.normals ? " 1 1 1" : "") << (layout.colours ? " 1" : "")
      << "\nWIDTH " << (organised ? std::uint64_t{cloud.width} : cloud.size()) << "\nHEIGHT "
      << (organised ? cloud.height : 1) << "\nVIEWPOINT " << v.x() << ' ' << v.y() << ' ' << v.z()
      << " 1 0 0 0\nPOINTS " << cloud.size() << "\nDATA binary\n";
  return out.str();
}

void append_position(std::string& bytes, const PointCloud& cloud, std::size_t i, bool doubles) {
  for (int axis = 0; axis < 3; ++axis) {
    const float local = cloud.points[i][axis];
    if (doubles) {
      append(bytes, cloud.origin[axis] + static_cast<double>(local));
    } else {
      append(bytes, local);
    }
  }
}

void append_point(
    std::string& bytes, const PointCloud& cloud, std::size_t i, const Layout& layout, bool pcd) {
  append_position(bytes, cloud, i, layout.doubles);
  if (layout.normals) {
    for (int axis = 0; axis < 3; ++axis) append(bytes, cloud.normals[i][axis]);
  }
  if (layout.colours) {
    const auto& [red, green, blue] = cloud.colours[i];
    if (pcd) {
      append(bytes, (std::uint32_t{red} << 16U) | (std::uint32_t{green} << 8U) | blue);
    } else {
      append(bytes, red);
      append(bytes, green);
      append(bytes, blue);
    }
  }
  if (layout.viewpoint_index && !pcd) append(bytes, cloud.viewpoint_index[i]);
}

}  // namespace

void write_cloud(const std::filesystem::path& path, const PointCloud& cloud) {
  constexpr std::size_t kBuffer = std::size_t{1} << 20U;
  const bool pcd = path.extension() == ".pcd";
  const Layout layout = choose_layout(cloud);
  OutputFile file(path);
  file.write(pcd ? pcd_header(cloud, layout) : ply_header(cloud, layout));
  std::string bytes;
  bytes.reserve(kBuffer + 256);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    append_point(bytes, cloud, i, layout, pcd);
    if (bytes.size() < kBuffer) continue;
    file.write(bytes);
    bytes.clear();
  }
  file.write(bytes);
  file.close();
}

}  // namespace landmarkdb
