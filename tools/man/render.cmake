# Every page of ${from} through scdoc into ${to}; those of subcommands that are gone do not stay.
file(REMOVE_RECURSE ${to})
file(MAKE_DIRECTORY ${to})
file(GLOB pages ${from}/*.scd)
foreach(page IN LISTS pages)
  get_filename_component(name ${page} NAME_WLE)
  execute_process(COMMAND ${scdoc} INPUT_FILE ${page} OUTPUT_FILE ${to}/${name} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
