# find_package(hb) gives the targets hb::lib and hb::hb; headers are included as "lib/rod.hpp", "hb/stability.hpp".
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(HB_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/hb)

install(TARGETS hb_lib hb_engine EXPORT hb_targets)
install(EXPORT hb_targets NAMESPACE hb:: FILE hb-targets.cmake DESTINATION ${HB_PACKAGE_DIR})
foreach(folder lib hb)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/hb/${folder}
    FILES_MATCHING PATTERN "*.hpp")
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
  install(TARGETS hb_mpi)
endif()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
