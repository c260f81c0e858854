# Debian's FFTW comes with pkg-config only: one imported target for it, made here for the build and for the installed
# package alike.
if(NOT TARGET hb::fftw3)
  find_path(FFTW3_INCLUDE_DIR fftw3.h)
  find_library(FFTW3_LIBRARY fftw3)
  mark_as_advanced(FFTW3_INCLUDE_DIR FFTW3_LIBRARY)
  if(FFTW3_INCLUDE_DIR AND FFTW3_LIBRARY)
    add_library(hb::fftw3 UNKNOWN IMPORTED)
    set_target_properties(hb::fftw3 PROPERTIES
      IMPORTED_LOCATION "${FFTW3_LIBRARY}"
      INTERFACE_INCLUDE_DIRECTORIES "${FFTW3_INCLUDE_DIR}")
  endif()
endif()
