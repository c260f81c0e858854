find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(tomlplusplus REQUIRED)

# Debian's FFTW comes with pkg-config only; one imported target for it.
find_path(FFTW3_INCLUDE_DIR fftw3.h REQUIRED)
find_library(FFTW3_LIBRARY fftw3 REQUIRED)
mark_as_advanced(FFTW3_INCLUDE_DIR FFTW3_LIBRARY)
if(NOT TARGET hb::fftw3)
  add_library(hb::fftw3 UNKNOWN IMPORTED)
  set_target_properties(hb::fftw3 PROPERTIES
    IMPORTED_LOCATION "${FFTW3_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${FFTW3_INCLUDE_DIR}")
endif()

find_package(fmt REQUIRED)
find_package(CLI11 REQUIRED)
find_package(nlohmann_json REQUIRED)
