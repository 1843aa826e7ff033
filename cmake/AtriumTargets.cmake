# The three ways in which Atrium makes a target. Folder = module = target; every source is named, nothing is globbed.

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_C_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()

# What nearly every source includes is parsed once, which is a good part of the work of a build from nothing. Sources still include
# what they use: -DATRIUM_PCH=OFF builds without. The flags of the PCH have to be those of the sources, so fmt, which sets one, is linked
# by all.
option(ATRIUM_PCH "Precompile the common headers" ON)
set(CMAKE_PCH_WARN_INVALID OFF) # a target with flags of its own (-pthread) parses the headers itself
set(ATRIUM_PCH_HEADERS <algorithm> <array> <chrono> <cmath> <condition_variable> <filesystem> <fstream> <functional> <map>
    <memory> <mutex> <optional> <random> <set> <span> <string> <thread> <vector> <Eigen/Core> <Eigen/Geometry>
    <fmt/format.h> <tl/expected.hpp>)
set(ATRIUM_TEST_PCH_HEADERS <gtest/gtest.h> <gmock/gmock.h>)
# Of what tests do themselves; what they test is as fast as ever. Of what sanitizers add, -O1 takes a third longer to compile.
set(ATRIUM_TEST_OPTIMISATION $<$<CONFIG:RelWithDebInfo>:-O1> $<$<CONFIG:Sanitize>:-Og>)

# Several sources of a library at once is a good part less work for a build from nothing, and more for one after a change: CI's
# sanitizer builds want it. Sources still include what they use and name things apart.
option(ATRIUM_UNITY "Compile the sources of each library together" OFF)

# _atrium_pch(target code|test): the PCH of this kind is made by a target of its own, the first time one asks for it.
function(_atrium_pch target kind)
    target_link_libraries(${target} PRIVATE fmt::fmt)
    if(NOT ATRIUM_PCH)
        return()
    endif()
    if(NOT TARGET pch_${kind})
        file(WRITE ${CMAKE_BINARY_DIR}/pch_${kind}.cpp "")
        add_library(pch_${kind} OBJECT ${CMAKE_BINARY_DIR}/pch_${kind}.cpp)
        target_link_libraries(pch_${kind} PRIVATE fmt::fmt Eigen3::Eigen tl::expected)
        target_precompile_headers(pch_${kind} PRIVATE ${ATRIUM_PCH_HEADERS})
        if(kind STREQUAL test)
            target_link_libraries(pch_${kind} PRIVATE GTest::gtest GTest::gmock)
            target_precompile_headers(pch_${kind} PRIVATE ${ATRIUM_TEST_PCH_HEADERS})
            target_compile_options(pch_${kind} PRIVATE ${ATRIUM_TEST_OPTIMISATION})
        endif()
        _atrium_options(pch_${kind})
    endif()
    target_precompile_headers(${target} REUSE_FROM pch_${kind})
endfunction()

function(_atrium_options target)
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wshadow -Wnon-virtual-dtor>
                           $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-stringop-overflow -Wno-restrict -Wno-array-bounds>) # wrong alarms of g++ 12 in fmt and std::string
    if(ATRIUM_UNITY)
        # a type of one source alone may have members of that source's own types
        target_compile_options(${target} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-subobject-linkage>)
    endif()
    if(ATRIUM_WERROR)
        target_compile_options(${target} PRIVATE -Werror)
    endif()
    if(ATRIUM_SANITIZE)
        target_compile_options(${target} PRIVATE -fsanitize=${ATRIUM_SANITIZE} -fno-omit-frame-pointer
                                                 -fno-sanitize-recover=all)
        target_link_options(${target} PUBLIC -fsanitize=${ATRIUM_SANITIZE})
    endif()
endfunction()

# atrium_library(name SOURCES a.cpp ... PUBLIC lib ... PRIVATE lib ...)
function(atrium_library name)
    cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
    add_library(${name} STATIC ${ARG_SOURCES})
    target_link_libraries(${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
    set_target_properties(${name} PROPERTIES UNITY_BUILD ${ATRIUM_UNITY})
    _atrium_options(${name})
    _atrium_pch(${name} code)
endfunction()

# atrium_program(name SOURCES main.cpp ... LINK lib ...); the target `programs` is all of them.
function(atrium_program name)
    cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
    add_executable(${name} ${ARG_SOURCES})
    target_link_libraries(${name} PRIVATE ${ARG_LINK})
    _atrium_options(${name})
    _atrium_pch(${name} code)
    if(NOT TARGET programs)
        add_custom_target(programs)
    endif()
    add_dependencies(programs ${name})
endfunction()

# atrium_test(name LABELS unit ... SOURCES a_test.cpp ... LINK lib ... [TIMEOUT seconds])
# One executable and one ctest entry per module; labels: unit property golden fuzz integration gl dds threads.
# `threads` marks what the ThreadSanitizer run executes; `integration` and `dds`, whose peers have to be in time, have the machine
# to themselves.
function(atrium_test name)
    cmake_parse_arguments(ARG "" "TIMEOUT" "LABELS;SOURCES;LINK" ${ARGN})
    add_executable(${name} ${ARG_SOURCES})
    target_link_libraries(${name} PRIVATE ${ARG_LINK} GTest::gtest GTest::gmock GTest::gtest_main)
    target_compile_definitions(${name} PRIVATE ATRIUM_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    _atrium_options(${name})
    target_compile_options(${name} PRIVATE ${ATRIUM_TEST_OPTIMISATION})
    _atrium_pch(${name} test)
    add_test(NAME ${name} COMMAND ${name})
    if(NOT ARG_TIMEOUT)
        set(ARG_TIMEOUT 300)
    endif()
    if(ATRIUM_SANITIZE)
        math(EXPR ARG_TIMEOUT "3 * ${ARG_TIMEOUT}") # the limit ends what hangs; it is no bar for what is slow
    endif()
    set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT})
    set_tests_properties(${name} PROPERTIES ENVIRONMENT
                         "TSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/tsan.supp;LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/lsan.supp:print_suppressions=0")
    if("integration" IN_LIST ARG_LABELS OR "dds" IN_LIST ARG_LABELS)
        set_tests_properties(${name} PROPERTIES RUN_SERIAL ON)
    endif()
    # `cmake --build build --target tests_threads` builds what `ctest -L threads` runs
    foreach(label ${ARG_LABELS})
        if(NOT TARGET tests_${label})
            add_custom_target(tests_${label})
        endif()
        add_dependencies(tests_${label} ${name})
    endforeach()
endfunction()
