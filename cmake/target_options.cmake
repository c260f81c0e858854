set(HB_NATIVE_FLAGS)
if(HB_NATIVE)
  set(HB_NATIVE_FLAGS -march=native)
  if(NOT HB_AVX512 AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    set(HB_NATIVE_FLAGS -march=x86-64-v3)
  endif()
endif()

# Flags of our own targets only.
function(hb_target_options target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic
    $<$<BOOL:${HB_WERROR}>:-Werror>
    # A member that an initialiser leaves out keeps the default that its declaration gives.
    -Wno-missing-field-initializers
    # GCC 12 sees overlapping copies in std::string operator+ where there are none (GCC bug 105651).
    $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>
    # -ffast-math would remove the NaN tests that detect divergence; these three are safe.
    -fno-math-errno $<$<CXX_COMPILER_ID:GNU>:-fcx-limited-range> -fno-trapping-math
    # Nobody puts functions of their own in place of these: those of one file call and inline each other directly.
    $<$<CXX_COMPILER_ID:GNU>:-fno-semantic-interposition>
    # kB from which GCC clears its memory away. Late: a tenth less time for 100 to 400 MB more; with sanitizers, which take
    # more memory, that gains nothing.
    $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=$<IF:$<BOOL:${HB_SANITIZE}>,100000,800000>>)
  if(HB_NATIVE)
    target_compile_options(${target} PRIVATE ${HB_NATIVE_FLAGS}
      # GCC 12 warns of its own AVX-512 intrinsics, whose undefined operands are meant (GCC bug 105593) and whose masked
      # loads of small matrices it takes for whole ones.
      $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-maybe-uninitialized$<SEMICOLON>-Wno-uninitialized$<SEMICOLON>-Wno-array-bounds>)
  endif()
  # One alignment whatever the instruction set, so that libraries and their users agree on Eigen's allocations.
  target_compile_definitions(${target} PUBLIC EIGEN_MAX_ALIGN_BYTES=64)
  # fmt compares formats with what they format when it runs, as it does anyway; the preset `developer` does so when it
  # compiles, which takes a sixth of the time of the files that put words together.
  target_compile_definitions(${target} PRIVATE $<$<CONFIG:Release>:FMT_CONSTEVAL=>)
  if(HB_SANITIZE)
    # Not asked for apart, which costs two fifths of the compile time: null pointers, whose use AddressSanitizer reports
    # as well, and alignment, which Eigen asserts where it matters.
    target_compile_options(${target} PRIVATE -fsanitize=address,undefined -fno-sanitize=null,alignment
      -fno-sanitize-recover=all -fno-omit-frame-pointer
      # In instrumented code GCC sees uninitialised variables where there are none; other builds keep the warning.
      $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
    # Public: whoever links an instrumented static library needs the runtime.
    target_link_options(${target} PUBLIC -fsanitize=address,undefined)
  endif()
endfunction()

# Searches and analyses ask the engine and put together what it answers: sweeps and maps take as long whether these are
# optimised or not, and words, files, pictures and tests cost as little. Optimised lightly they compile in seven tenths of
# the time.
function(hb_lightly_optimised)
  foreach(target IN LISTS ARGN)
    if(TARGET ${target})
      # At -O1 alone GCC leaves the upper halves of vector registers in use behind, which makes every SSE instruction of
      # the mathematical functions wait on Intel's processors with AVX-512: the search of a sweep of Mathieu's equation took four
      # times as long. Products and sums stay apart as at -O1: a place of a grid at zero is zero.
      target_compile_options(${target} PRIVATE
        $<$<CONFIG:Release>:-O1 $<$<CXX_COMPILER_ID:GNU>:-fexpensive-optimizations -ffp-contract=off>>)
    endif()
  endforeach()
endfunction()

# Headers of Eigen and the standard library, read once for each kind of target: one precompiled set for the numerics, one
# with JSON for what is lightly optimised, one with JSON and GoogleTest for the tests (the optimisation of a set is that of
# all that is compiled with it, whatever their own flags say); they also say which products of matrices
# are compiled elsewhere (lib/product_kernels.hpp), which saves a tenth of the compile time. Each belongs to a target
# without flags of its own, since a set serves only those who define what it was made with.
option(HB_PRECOMPILED_HEADERS "Read Eigen and the standard library once for each kind of target" ON)
function(hb_header_set name)
  if(NOT HB_PRECOMPILED_HEADERS)
    return()
  endif()
  file(WRITE ${PROJECT_BINARY_DIR}/header_sets/${name}.cpp "")
  add_library(hb_headers_${name} OBJECT ${PROJECT_BINARY_DIR}/header_sets/${name}.cpp)
  hb_target_options(hb_headers_${name})
  target_compile_features(hb_headers_${name} PUBLIC cxx_std_20)
  target_link_libraries(hb_headers_${name} PRIVATE Eigen3::Eigen)
  # Named from the root, so that a compiler cache serves every copy of the project.
  target_include_directories(hb_headers_${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_precompile_headers(hb_headers_${name} PRIVATE <Eigen/Dense> <algorithm> <array> <cmath> <complex> <functional>
    <map> <memory> <optional> <string> <utility> <vector> <lib/product_kernels.hpp> ${ARGN})
endfunction()
function(hb_precompiled target name)
  if(HB_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} REUSE_FROM hb_headers_${name})
  endif()
endfunction()

# What the files of a folder share (templates of Eigen and JSON above all) is compiled once for many of them:
# hb_grouped(TARGET AT_ONCE files ALONE file...), a folder in as few equal groups as have at most so many files, those of
# ALONE apart, which take long by themselves. The groups name their files from the root of the project, so that a compiler
# cache serves every copy of it.
option(HB_GROUPED_SOURCES "Compile the files of a folder together" ON)
function(hb_grouped target)
  if(NOT HB_GROUPED_SOURCES)
    return()
  endif()
  cmake_parse_arguments(PARSE_ARGV 1 group "" "AT_ONCE" "ALONE")
  get_target_property(sources ${target} SOURCES)
  set(folders)
  foreach(source IN LISTS sources)
    get_source_file_property(own_definitions ${source} COMPILE_DEFINITIONS)
    if(own_definitions OR source IN_LIST group_ALONE)
      continue()
    endif()
    get_filename_component(folder ${source} DIRECTORY)
    string(MAKE_C_IDENTIFIER "${folder}" folder)
    list(APPEND folders "${folder}_")
    list(APPEND files_${folder}_ ${source})
    set_source_files_properties(${source} PROPERTIES HEADER_FILE_ONLY ON)
  endforeach()
  list(REMOVE_DUPLICATES folders)
  foreach(folder IN LISTS folders)
    list(LENGTH files_${folder} count)
    math(EXPR last "(${count} - 1) / ${group_AT_ONCE}")
    foreach(number RANGE ${last})
      math(EXPR first "${number} * ${count} / (${last} + 1)")
      math(EXPR length "(${number} + 1) * ${count} / (${last} + 1) - ${first}")
      list(SUBLIST files_${folder} ${first} ${length} files)
      set(text)
      foreach(file IN LISTS files)
        file(RELATIVE_PATH name ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR}/${file})
        string(APPEND text "#include \"${name}\"\n")
      endforeach()
      set(group ${PROJECT_BINARY_DIR}/groups/${target}_${folder}${number}.cpp)
      file(CONFIGURE OUTPUT ${group} CONTENT "${text}" @ONLY)
      target_sources(${target} PRIVATE ${group})
    endforeach()
  endforeach()
endfunction()
