find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(tomlplusplus REQUIRED)
find_package(fmt REQUIRED)
find_package(NLopt REQUIRED)

# Whole, or the two libraries used beside headers that tools/setup.sh unpacked.
find_package(SUNDIALS 6.4 QUIET COMPONENTS cvode nvecserial)
if(NOT SUNDIALS_FOUND)
  find_path(HB_SUNDIALS_HEADERS cvode/cvode.h PATHS ${PROJECT_SOURCE_DIR}/build/sundials/usr/include)
  if(NOT HB_SUNDIALS_HEADERS)
    message(FATAL_ERROR "SUNDIALS not found: run tools/setup.sh, or install Debian's libsundials-dev")
  endif()
  foreach(library cvode nvecserial)
    find_library(HB_SUNDIALS_${library} NAMES libsundials_${library}.so.6 REQUIRED)
    add_library(SUNDIALS::${library} SHARED IMPORTED)
    set_target_properties(SUNDIALS::${library} PROPERTIES
      IMPORTED_LOCATION ${HB_SUNDIALS_${library}} INTERFACE_INCLUDE_DIRECTORIES ${HB_SUNDIALS_HEADERS})
  endforeach()
endif()

include(${CMAKE_CURRENT_LIST_DIR}/fftw3.cmake)
if(NOT TARGET hb::fftw3)
  message(FATAL_ERROR "FFTW not found (Debian: libfftw3-dev)")
endif()

# Of the command and the tests only.
if(PROJECT_IS_TOP_LEVEL)
  find_package(CLI11 REQUIRED)
  find_package(nlohmann_json REQUIRED)
  if(CMAKE_SYSTEM_NAME STREQUAL "Linux" AND NOT HB_SANITIZE)
    find_package(mimalloc 2.0 REQUIRED)
  endif()
endif()
