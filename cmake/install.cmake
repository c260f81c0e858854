# find_package(hb) gives the targets hb::lib, hb::engine and hb::hb; headers are included as "hb/lib/rod/rod.hpp",
# "hb/engine/exponents/stability.hpp": the tree's "lib/..." is installed under hb/, so that no name but hb is taken.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(HB_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/hb)

install(TARGETS hb_lib hb_engine hb_analysis EXPORT hb_targets)
install(EXPORT hb_targets NAMESPACE hb:: FILE hb-targets.cmake DESTINATION ${HB_PACKAGE_DIR})

file(GLOB_RECURSE headers RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS
  ${PROJECT_SOURCE_DIR}/lib/*.hpp ${PROJECT_SOURCE_DIR}/hb/*.hpp)
foreach(header IN LISTS headers)
  file(READ ${PROJECT_SOURCE_DIR}/${header} text)
  string(REPLACE "#include \"lib/" "#include \"hb/lib/" text "${text}")
  string(REGEX REPLACE "^lib/" "hb/lib/" place ${header})
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/include/${place} CONTENT "${text}" @ONLY)
  cmake_path(GET place PARENT_PATH folder)
  install(FILES ${PROJECT_BINARY_DIR}/include/${place} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${folder})
endforeach()

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/hb-config.cmake.in ${PROJECT_BINARY_DIR}/hb-config.cmake
  INSTALL_DESTINATION ${HB_PACKAGE_DIR} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/hb-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/hb-config.cmake ${PROJECT_BINARY_DIR}/hb-config-version.cmake
  ${CMAKE_CURRENT_LIST_DIR}/fftw3.cmake DESTINATION ${HB_PACKAGE_DIR})

if(TARGET hb_command)
  install(TARGETS hb_command)
endif()
if(TARGET hb_mpi)
  install(TARGETS hb_mpi OPTIONAL)
endif()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
