# The project's three kinds of target and the flags they share.

add_library(landmarkdb_flags INTERFACE)
target_compile_features(landmarkdb_flags INTERFACE cxx_std_20)
target_compile_options(landmarkdb_flags INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -Wnon-virtual-dtor -Woverloaded-virtual
  # GCC 12 sees overlapping copies in inlined std::string concatenation where there are none (its bug 105651).
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>
  $<$<BOOL:${LANDMARKDB_WERROR}>:-Werror>)
target_include_directories(landmarkdb_flags INTERFACE ${PROJECT_SOURCE_DIR})
# Under AddressSanitizer Eigen would allocate in its own way and PCL's libraries, built without, free what we
# allocated (a range image's points). This is what Eigen chooses by itself on 64-bit glibc otherwise.
string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type)
if("${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${build_type}}" MATCHES "sanitize=[a-z,]*address")
  target_compile_definitions(landmarkdb_flags INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
endif()
target_link_libraries(landmarkdb_flags INTERFACE Threads::Threads)

# landmarkdb_library(name SOURCES ... PUBLIC ... PRIVATE ...): a static library landmarkdb_<name>, seen by
# others as landmarkdb::<name>. Sources are relative to the calling folder.
function(landmarkdb_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(landmarkdb_${name} STATIC ${ARG_SOURCES})
  add_library(landmarkdb::${name} ALIAS landmarkdb_${name})
  target_link_libraries(landmarkdb_${name} PUBLIC ${ARG_PUBLIC} PRIVATE landmarkdb_flags ${ARG_PRIVATE})
endfunction()

# What a preset builds when it needs not everything: all programs, and the tests of one label.
add_custom_target(programs)
foreach(label unit integration concurrency slow)
  add_custom_target(tests_${label})
endforeach()

# landmarkdb_program(target SOURCES ... LINK ...): an executable in ${CMAKE_BINARY_DIR}/bin.
function(landmarkdb_program target)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE landmarkdb_flags ${ARG_LINK})
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
  add_dependencies(programs ${target})
endfunction()

# landmarkdb_test(target LABEL unit|integration|concurrency|slow SOURCES ... LINK ...): one GoogleTest
# program, each of its tests a CTest test with the label.
function(landmarkdb_test target)
  cmake_parse_arguments(ARG "" "LABEL" "SOURCES;LINK" ${ARGN})
  if(NOT LANDMARKDB_BUILD_TESTS)
    return()
  endif()
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE landmarkdb_flags ${ARG_LINK} GTest::gmock_main)
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  add_dependencies(tests_${ARG_LABEL} ${target})
  # What is tested is compiled as users get it; the tests themselves need not be fast: a quarter less to wait for.
  if(CMAKE_CXX_FLAGS_RELEASE MATCHES "-O[23]")
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  gtest_discover_tests(${target} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60
    # Two properties of one value each: a list here would be taken apart on its way to ctest.
    PROPERTIES LABELS ${ARG_LABEL} TIMEOUT 600
      ENVIRONMENT "LANDMARKDB_REAL_DATA=${LANDMARKDB_REAL_DATA}"
      ENVIRONMENT_MODIFICATION "LANDMARKDB_BIN=set:${CMAKE_BINARY_DIR}/bin")
endfunction()
