function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "failed (${result}): ${command}")
  endif()
endfunction()

file(REMOVE_RECURSE ${work})
run(${CMAKE_COMMAND} --install ${build} --config ${config} --prefix ${work}/prefix)
run(${CMAKE_COMMAND} -S ${consumer} -B ${work}/build -G ${generator} -D CMAKE_CXX_COMPILER=${compiler}
  -D CMAKE_BUILD_TYPE=${config} -D CMAKE_PREFIX_PATH=${work}/prefix -D CMAKE_FIND_USE_PACKAGE_REGISTRY=OFF
  -D README_PROGRAM=${program}.cpp)
run(${CMAKE_COMMAND} --build ${work}/build --config ${config})
run(${work}/build/consumer)
execute_process(COMMAND ${work}/build/readme WORKING_DIRECTORY ${source} OUTPUT_VARIABLE printed RESULT_VARIABLE result)
file(READ ${program}.txt expected)
if(NOT result EQUAL 0 OR NOT printed STREQUAL expected)
  message(FATAL_ERROR "README's program (${result}) printed:\n${printed}\nREADME says:\n${expected}")
endif()
run(${work}/prefix/bin/hb --help)

# The same program by pkg-config.
find_program(pkg_config pkg-config)
if(pkg_config)
  run(${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${work}/prefix/${libdir}/pkgconfig sh -c
    "'${compiler}' -std=c++20 '${consumer}/main.cpp' -o '${work}/by_pkg_config' $('${pkg_config}' --cflags --libs hb)")
  run(${work}/by_pkg_config)
endif()
