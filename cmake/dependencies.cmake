# Everything comes from Debian; nothing is downloaded.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(ZLIB REQUIRED)
find_package(PNG REQUIRED)
find_package(JPEG REQUIRED)
find_package(OpenSSL 3 REQUIRED)
find_package(SQLite3 3.37 REQUIRED)
find_package(Protobuf 3.21 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(CLI11 2.1 REQUIRED)
find_package(yaml-cpp 0.7 REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(zstd REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(lz4 REQUIRED IMPORTED_TARGET liblz4)
if(LANDMARKDB_BUILD_TESTS)
  find_package(GTest 1.12 REQUIRED)
  include(GoogleTest)
endif()

# PCL's own configuration looks for all of PCL, VTK and Qt included, and takes half a minute. We use three
# of its libraries, so we name them: SHOT and normals, keypoints, and what these two stand on.
find_path(LANDMARKDB_PCL_INCLUDE pcl/pcl_config.h PATH_SUFFIXES pcl-1.13 REQUIRED)
foreach(part common search kdtree octree filters features keypoints)
  find_library(LANDMARKDB_PCL_${part} pcl_${part} REQUIRED)
  add_library(pcl::${part} SHARED IMPORTED)
  set_target_properties(pcl::${part} PROPERTIES
    IMPORTED_LOCATION ${LANDMARKDB_PCL_${part}}
    INTERFACE_INCLUDE_DIRECTORIES ${LANDMARKDB_PCL_INCLUDE}
    INTERFACE_LINK_LIBRARIES Eigen3::Eigen)
endforeach()
