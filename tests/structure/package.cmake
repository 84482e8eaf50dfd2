# Installs the build BUILD under WORK and builds and runs the project CONSUMER with it.
function(run)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(NOT status EQUAL 0)
        message(FATAL_ERROR "${ARGN}\n${output}")
    endif()
    set(output "${output}" PARENT_SCOPE)
endfunction()

# Objects that were instrumented want the same of those that link them.
set(flags "")
if(SANITIZE)
    string(APPEND flags " -fsanitize=${SANITIZE}")
endif()
if(COVERAGE)
    string(APPEND flags " --coverage")
endif()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -S ${CONSUMER} -B ${WORK}/build -G Ninja -DCMAKE_CXX_COMPILER=${COMPILER}
    -DCMAKE_PREFIX_PATH=${WORK}/prefix "-DCMAKE_CXX_FLAGS=${flags}")
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${CMAKE_COMMAND} -E chdir ${WORK} ${WORK}/build/consumer)
if(NOT output MATCHES "^ACEScg latlong\nnowhere.jpg: .+\n3\n$")
    message(FATAL_ERROR "the consumer said: ${output}")
endif()

# The installed program reads what needs the module from where it was installed, and says so when it is gone.
set(program ${WORK}/prefix/bin/chromeball)
run(${program} --help)
run(${program} info ${WORK}/consumer.hdr)
file(GLOB_RECURSE module ${WORK}/prefix/chromeball_oiio.so)
file(REMOVE ${module})
execute_process(COMMAND ${program} info ${WORK}/consumer.hdr RESULT_VARIABLE status ERROR_VARIABLE said)
if(NOT status EQUAL 1 OR NOT said MATCHES "consumer.hdr: this format needs chromeball_oiio.so, .+; install")
    message(FATAL_ERROR "without its module the program ended with ${status}: ${said}")
endif()
