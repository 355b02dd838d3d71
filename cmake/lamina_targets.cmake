# Flags for lamina's own targets, never for its users'.
add_library(lamina_flags INTERFACE)
target_compile_options(lamina_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow
  -Wno-missing-field-initializers  # designated initializers leave defaults out on purpose
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # false alarms of GCC 12 on strings, its bug 105651
  $<$<BOOL:${LAMINA_WARNINGS_AS_ERRORS}>:-Werror>
  -fno-math-errno -fno-trapping-math)  # without these, loops over exp, sqrt and floor do not vectorize
if(LAMINA_FUZZ)  # a path below the build folder's, so that a compiler cache finds objects of other checkouts
  cmake_path(RELATIVE_PATH PROJECT_SOURCE_DIR BASE_DIRECTORY ${PROJECT_BINARY_DIR} OUTPUT_VARIABLE lamina_folder)
  target_compile_options(lamina_flags INTERFACE
    -fsanitize-coverage-ignorelist=${lamina_folder}/tests/fuzz/uncounted.txt)
endif()

# Highway, for sources that are compiled once per instruction set. Those left out help no loop of
# lamina, and cost time to compile.
add_library(lamina_simd INTERFACE)
target_link_libraries(lamina_simd INTERFACE hwy::hwy)
target_compile_definitions(lamina_simd INTERFACE HWY_DISABLED_TARGETS=\(HWY_SSSE3|HWY_AVX3_DL\))

# Precompiled headers: what most sources include is parsed once for all rooms. Fast builds compile
# sources of a room a few at a time, too, which compiler caches find less of. Only for speed: every
# file names what it needs, and no two sources of a room have the same name for different things,
# which builds without these options check.
if(LAMINA_PRECOMPILED_HEADERS)
  file(WRITE ${PROJECT_BINARY_DIR}/nothing.cpp "")
  add_library(lamina_precompiled OBJECT ${PROJECT_BINARY_DIR}/nothing.cpp)
  target_compile_features(lamina_precompiled PRIVATE cxx_std_20)
  set_target_properties(lamina_precompiled PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_link_libraries(lamina_precompiled PRIVATE lamina_flags)
  target_precompile_headers(lamina_precompiled PRIVATE <algorithm> <array> <cmath> <filesystem>
    <functional> <limits> <memory> <numbers> <optional> <span> <sstream> <string> <variant> <vector>)
  target_compile_options(lamina_flags INTERFACE
    $<$<BOOL:${LAMINA_FAST_BUILD}>:-Wno-shadow>  # of names in other sources
    # GCC 12 warns of its own headers once they are parsed.
    "$<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow;-Wno-array-bounds;-Wno-alloc-size-larger-than;-Wno-subobject-linkage>")
endif()

set(lamina_batch 20)
if(CMAKE_UNITY_BUILD_BATCH_SIZE)
  set(lamina_batch ${CMAKE_UNITY_BUILD_BATCH_SIZE})
endif()

# lamina_build_fast(TARGET): by the options LAMINA_PRECOMPILED_HEADERS and LAMINA_FAST_BUILD.
function(lamina_build_fast target)
  if(LAMINA_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} REUSE_FROM lamina_precompiled)
  endif()
  if(NOT LAMINA_FAST_BUILD)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${lamina_batch})
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    if(source MATCHES "[.]cpp$" AND EXISTS ${source})
      file(STRINGS ${source} per_target REGEX "hwy/foreach_target.h")
      if(per_target)  # compiled once per instruction set, by a name of its own
        set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
      endif()
    endif()
  endforeach()
endfunction()

# lamina_is_cold(TARGET): reads, checks and prints, and is seldom waited for.
function(lamina_is_cold target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# lamina_library(NAME [FOLDERS f...] [SOURCES s...] [HEADERS h...] [LINKS l...] [PRIVATE_LINKS l...]):
# this folder, and those below it that are named, as lamina::NAME. Headers are public, unless they lie
# in a folder "internal" or others are named.
function(lamina_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "FOLDERS;SOURCES;HEADERS;LINKS;PRIVATE_LINKS")
  foreach(folder IN ITEMS . LISTS arg_FOLDERS)
    file(GLOB sources CONFIGURE_DEPENDS ${folder}/*.cpp ${folder}/internal/*.cpp)
    file(GLOB headers CONFIGURE_DEPENDS ${folder}/*.h)
    list(APPEND all_sources ${sources})
    list(APPEND all_headers ${headers})
  endforeach()
  if(arg_HEADERS)
    set(all_headers ${arg_HEADERS})
  endif()
  add_library(lamina_${name} ${arg_SOURCES} ${all_sources})
  add_library(lamina::${name} ALIAS lamina_${name})
  target_sources(lamina_${name} PUBLIC FILE_SET HEADERS
    BASE_DIRS ${PROJECT_SOURCE_DIR}/src FILES ${all_headers})
  target_compile_features(lamina_${name} PUBLIC cxx_std_20)
  set_target_properties(lamina_${name} PROPERTIES
    EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON VERIFY_INTERFACE_HEADER_SETS ON)
  target_link_libraries(lamina_${name} PUBLIC ${arg_LINKS}
    PRIVATE ${arg_PRIVATE_LINKS} $<BUILD_INTERFACE:lamina_flags>)
  lamina_build_fast(lamina_${name})
  install(TARGETS lamina_${name} EXPORT lamina_targets FILE_SET HEADERS)
endfunction()

# lamina_fingerprint(NAME HEADER MACRO FOLDERS f...): a header of the library NAME whose macro is a
# hash of all sources in folders of src/lamina and of all that they include. What a cache keeps
# belongs to the code that made it.
function(lamina_fingerprint name header macro)
  cmake_parse_arguments(PARSE_ARGV 3 arg "" "" "FOLDERS")
  foreach(folder IN LISTS arg_FOLDERS)
    file(GLOB_RECURSE found CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/lamina/${folder}/*.cpp)
    list(APPEND sources ${found})
  endforeach()
  set(fingerprint ${CMAKE_CURRENT_BINARY_DIR}/${header})
  add_custom_command(OUTPUT ${fingerprint} VERBATIM
    COMMAND ${CMAKE_COMMAND} -D "SOURCES=${sources}" -D ROOT=${PROJECT_SOURCE_DIR}/src
      -D NAME=${macro} -D HEADER=${fingerprint} -D DEPFILE=${fingerprint}.d
      -P ${PROJECT_SOURCE_DIR}/cmake/fingerprint.cmake
    DEPENDS ${sources} ${PROJECT_SOURCE_DIR}/cmake/fingerprint.cmake
    DEPFILE ${fingerprint}.d)
  target_sources(lamina_${name} PRIVATE ${fingerprint})
  # A target without dependencies: the header is there before any library is built.
  add_custom_target(lamina_${name}_fingerprint DEPENDS ${fingerprint})
  target_include_directories(lamina_${name} PRIVATE ${CMAKE_CURRENT_BINARY_DIR})
endfunction()
