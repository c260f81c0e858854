find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(tomlplusplus REQUIRED)
find_package(fmt REQUIRED)
find_package(NLopt REQUIRED)
find_package(SUNDIALS 6.4 REQUIRED COMPONENTS cvode nvecserial)

include(${CMAKE_CURRENT_LIST_DIR}/fftw3.cmake)
if(NOT TARGET hb::fftw3)
  message(FATAL_ERROR "FFTW not found (Debian: libfftw3-dev)")
endif()

# Of the command and the tests only.
if(PROJECT_IS_TOP_LEVEL)
  find_package(CLI11 REQUIRED)
  find_package(nlohmann_json REQUIRED)
endif()
