# find_package(hb) gives the targets hb::lib, hb::engine and hb::hb; headers are included as "hb/lib/rod/rod.hpp",
# "hb/engine/exponents/stability.hpp": the tree's "lib/..." is installed under hb/, so that no name but hb is taken.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(HB_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/hb)

install(TARGETS hb_lib hb_engine hb_analysis EXPORT hb_targets)
install(EXPORT hb_targets NAMESPACE hb:: FILE hb-targets.cmake DESTINATION ${HB_PACKAGE_DIR})

# All headers are for users but those that include what the libraries use inside.
set(HB_PRIVATE_HEADERS
  hb/engine/time/sundials_session.hpp
  lib/scene/plausibility.hpp
  lib/scene/scene_parts.hpp
  lib/scene/scene_paths.hpp
  lib/scene/scene_reader.hpp)
file(GLOB_RECURSE headers RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS
  ${PROJECT_SOURCE_DIR}/lib/*.hpp ${PROJECT_SOURCE_DIR}/hb/*.hpp)
list(REMOVE_ITEM headers ${HB_PRIVATE_HEADERS})
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
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CITATION.cff
  DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${PROJECT_SOURCE_DIR}/tools/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME manual.md)

# The prefix is known when installing, not before.
install(CODE "
  set(CMAKE_INSTALL_LIBDIR \"${CMAKE_INSTALL_LIBDIR}\")
  set(CMAKE_INSTALL_INCLUDEDIR \"${CMAKE_INSTALL_INCLUDEDIR}\")
  set(PROJECT_DESCRIPTION \"${PROJECT_DESCRIPTION}\")
  set(PROJECT_VERSION \"${PROJECT_VERSION}\")
  set(HB_COMPLETION_FOLDER \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}/bash-completion/completions\")
  configure_file(${PROJECT_SOURCE_DIR}/cmake/hb.pc.in ${PROJECT_BINARY_DIR}/hb.pc @ONLY)
  configure_file(${PROJECT_SOURCE_DIR}/tools/completion/_hb ${PROJECT_BINARY_DIR}/_hb @ONLY)")
install(FILES ${PROJECT_BINARY_DIR}/hb.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
install(FILES ${PROJECT_SOURCE_DIR}/tools/completion/hb.bash RENAME hb
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES ${PROJECT_BINARY_DIR}/_hb DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
