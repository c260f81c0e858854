# Flags of our own targets only.
function(hb_target_options target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic
    $<$<BOOL:${HB_WERROR}>:-Werror>
    # GCC 12 sees overlapping copies in std::string operator+ where there are none (GCC bug 105651).
    $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>
    # -ffast-math would remove the NaN tests that detect divergence; these three are safe.
    -fno-math-errno $<$<CXX_COMPILER_ID:GNU>:-fcx-limited-range> -fno-trapping-math)
  if(HB_NATIVE)
    target_compile_options(${target} PRIVATE -march=native)
  endif()
  # One alignment whatever the instruction set, so that libraries and their users agree on Eigen's allocations.
  target_compile_definitions(${target} PUBLIC EIGEN_MAX_ALIGN_BYTES=64)
  if(HB_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
      # In instrumented code GCC sees uninitialised variables where there are none; other builds keep the warning.
      $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
    # Public: whoever links an instrumented static library needs the runtime.
    target_link_options(${target} PUBLIC -fsanitize=address,undefined)
  endif()
endfunction()
