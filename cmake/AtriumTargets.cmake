# Functions that define Atrium's libraries, programs and tests. Folder = module = target; every source is listed, none globbed.

# With ccache all clones and build folders of a host share what was compiled once: paths count from the root of the tree, in assert too, and
# precompiled headers take part (GCC tells of them with -fpch-preprocess).
find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1
        CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE_PROGRAM})
    set(CMAKE_C_COMPILER_LAUNCHER ${CMAKE_CXX_COMPILER_LAUNCHER})
    add_compile_options($<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fpch-preprocess> -fmacro-prefix-map=${PROJECT_SOURCE_DIR}/=)
endif()

# gold, of the same package as the default linker, takes a quarter of its time.
find_program(GOLD_PROGRAM ld.gold)
if(GOLD_PROGRAM)
    add_link_options($<$<LINK_LANG_AND_ID:CXX,GNU>:-fuse-ld=gold>)
endif()

# All targets get the flags that some libraries ask for: a precompiled header serves only sources with its own flags.
add_compile_options(-pthread)
# GCC collects its own garbage less often: it is faster, and each compiler may take half a gigabyte more.
add_compile_options($<$<COMPILE_LANG_AND_ID:CXX,GNU>:--param=ggc-min-heapsize=524288>)

# Precompile the headers that nearly every source includes: they are a large part of a clean build. Sources still include what they
# use; -DATRIUM_PCH=OFF builds without. The PCH needs the flags of the sources: all targets link fmt, which sets a flag.
option(ATRIUM_PCH "Precompile the common headers" ON)
set(CMAKE_PCH_WARN_INVALID OFF) # a source with other flags parses the headers itself
set(ATRIUM_PCH_HEADERS <algorithm> <array> <chrono> <cmath> <condition_variable> <filesystem> <fstream> <functional> <map>
    <memory> <mutex> <optional> <random> <set> <span> <string> <thread> <vector> <Eigen/Core> <Eigen/Geometry>
    <fmt/format.h> <tl/expected.hpp>)
set(ATRIUM_TEST_PCH_HEADERS <gtest/gtest.h> <gmock/gmock.h>)
# What runs at the start or a few times a second (COLD), and the sources of tests, are compiled for a quick build: -Og is quicker than -O1,
# but its warnings of uninitialised variables are often false.
set(ATRIUM_COLD_OPTIMISATION $<$<CONFIG:RelWithDebInfo>:-O1> $<$<CONFIG:Sanitize>:-Og>)
set(ATRIUM_TEST_OPTIMISATION $<$<CONFIG:RelWithDebInfo,Sanitize>:-Og> $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-maybe-uninitialized>)

# Compiling the sources of a library or a test together, up to 24 at a time, makes a build from nothing faster and a rebuild after one
# change slower: turn it off while you work on one library. Sources include what they use, and their file-local names differ within
# a target, so both ways build.
option(ATRIUM_UNITY "Compile the sources of each library and each test together" ON)

function(_atrium_kind_options target kind)
    if(kind STREQUAL test)
        target_compile_options(${target} PRIVATE ${ATRIUM_TEST_OPTIMISATION})
    elseif(kind STREQUAL cold)
        target_compile_options(${target} PRIVATE ${ATRIUM_COLD_OPTIMISATION})
    endif()
endfunction()

# _atrium_pch(target code|cold|test): reuses the PCH of this kind. The first call creates the target that builds it.
function(_atrium_pch target kind)
    target_link_libraries(${target} PRIVATE fmt::fmt)
    _atrium_kind_options(${target} ${kind})
    if(NOT ATRIUM_PCH)
        return()
    endif()
    if(NOT TARGET pch_${kind})
        # leaves it as it is where it exists: else every run of CMake would compile everything again
        file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/pch_${kind}.cpp CONTENT "")
        add_library(pch_${kind} OBJECT ${CMAKE_BINARY_DIR}/pch_${kind}.cpp)
        target_link_libraries(pch_${kind} PRIVATE fmt::fmt Eigen3::Eigen tl::expected)
        target_precompile_headers(pch_${kind} PRIVATE ${ATRIUM_PCH_HEADERS})
        if(kind STREQUAL test)
            target_link_libraries(pch_${kind} PRIVATE GTest::gtest GTest::gmock)
            target_precompile_headers(pch_${kind} PRIVATE ${ATRIUM_TEST_PCH_HEADERS})
        endif()
        _atrium_options(pch_${kind})
        _atrium_kind_options(pch_${kind} ${kind})
    endif()
    target_precompile_headers(${target} REUSE_FROM pch_${kind})
endfunction()

function(_atrium_options target)
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wshadow -Wnon-virtual-dtor>
                           $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-stringop-overflow -Wno-restrict -Wno-array-bounds>) # false positives of g++ 12 in fmt and std::string
    if(ATRIUM_UNITY)
        # file-local types may have members of other file-local types
        target_compile_options(${target} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-subobject-linkage>)
    endif()
    if(ATRIUM_WERROR)
        target_compile_options(${target} PRIVATE -Werror)
    endif()
    if(ATRIUM_SANITIZE)
        target_compile_options(${target} PRIVATE -fsanitize=${ATRIUM_SANITIZE} -fno-omit-frame-pointer
                                                 -fno-sanitize-recover=all)
        if(ATRIUM_SANITIZE MATCHES undefined)
            # Checks at every access to memory: they cost g++ much time, and the address sanitizer finds most of what they find. clang++,
            # which builds the fuzzers, keeps them.
            target_compile_options(${target} PRIVATE
                $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fno-sanitize=alignment,null,object-size,pointer-overflow,vptr>)
        endif()
        target_link_options(${target} PUBLIC -fsanitize=${ATRIUM_SANITIZE})
        # Eigen allocates in another way under the address sanitizer, but Debian's Ceres, linked statically, has Eigen's functions of the
        # usual way, and the linker takes one of both.
        target_compile_definitions(${target} PRIVATE EIGEN_MALLOC_ALREADY_ALIGNED=1)
    endif()
endfunction()

# atrium_library(name [COLD] SOURCES a.cpp ... PUBLIC lib ... PRIVATE lib ...); COLD: compiled for a quick build, because its
# speed does not matter to the pictures of a site or a viewer.
function(atrium_library name)
    cmake_parse_arguments(ARG "COLD" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
    add_library(${name} STATIC ${ARG_SOURCES})
    target_link_libraries(${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
    set_target_properties(${name} PROPERTIES UNITY_BUILD ${ATRIUM_UNITY} UNITY_BUILD_BATCH_SIZE 24)
    _atrium_options(${name})
    if(ARG_COLD)
        _atrium_pch(${name} cold)
    else()
        _atrium_pch(${name} code)
    endif()
endfunction()

# The target that builds the programs of a folder; tests and benchmarks have targets of their own.
set(ATRIUM_PROGRAMS programs)

# atrium_program(name SOURCES main.cpp ... LINK lib ...); the target ${ATRIUM_PROGRAMS} builds it. Programs read their command line and
# leave the work to libraries, so they are compiled for a quick build; benchmarks are not.
function(atrium_program name)
    cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
    add_executable(${name} ${ARG_SOURCES})
    target_link_libraries(${name} PRIVATE ${ARG_LINK})
    _atrium_options(${name})
    if(ATRIUM_PROGRAMS STREQUAL programs)
        _atrium_pch(${name} cold)
    else()
        _atrium_pch(${name} code)
    endif()
    if(NOT TARGET ${ATRIUM_PROGRAMS})
        add_custom_target(${ATRIUM_PROGRAMS})
    endif()
    add_dependencies(${ATRIUM_PROGRAMS} ${name})
endfunction()

# atrium_test(name LABELS unit ... SOURCES a_test.cpp ... LINK lib ... [TIMEOUT seconds])
# One executable and one ctest entry per module; labels: unit property golden fuzz integration gl dds threads.
# `threads` marks the tests of the ThreadSanitizer run. `integration` and `dds` tests depend on timing and run alone.
# `slow` tests take more than some seconds: `make test` leaves them out.
# A test that is skipped for a reason outside tests/support/skips.hpp fails.
function(atrium_test name)
    cmake_parse_arguments(ARG "" "TIMEOUT" "LABELS;SOURCES;LINK" ${ARGN})
    add_executable(${name} ${ARG_SOURCES})
    target_link_libraries(${name} PRIVATE atrium_skips ${ARG_LINK} GTest::gtest GTest::gmock GTest::gtest_main)
    _atrium_options(${name})
    set_target_properties(${name} PROPERTIES UNITY_BUILD ${ATRIUM_UNITY} UNITY_BUILD_BATCH_SIZE 24)
    _atrium_pch(${name} test)
    add_test(NAME ${name} COMMAND ${name})
    if(NOT ARG_TIMEOUT)
        set(ARG_TIMEOUT 300)
    endif()
    if(ATRIUM_SANITIZE)
        math(EXPR ARG_TIMEOUT "3 * ${ARG_TIMEOUT}") # the limit ends hanging tests, not slow ones
    endif()
    set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT})
    set_tests_properties(${name} PROPERTIES ENVIRONMENT
                         "TSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/tsan.supp;LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/lsan.supp:print_suppressions=0")
    if("integration" IN_LIST ARG_LABELS OR "dds" IN_LIST ARG_LABELS)
        set_tests_properties(${name} PROPERTIES RUN_SERIAL ON)
    endif()
    # for example: `cmake --build build --target tests_threads` builds the tests of `ctest -L threads`
    foreach(label ${ARG_LABELS})
        if(NOT TARGET tests_${label})
            add_custom_target(tests_${label})
        endif()
        add_dependencies(tests_${label} ${name})
    endforeach()
    # the tests of `ctest -L 'unit|property' -LE slow`, which CI runs with sanitizers
    if(NOT TARGET tests_fast)
        add_custom_target(tests_fast)
    endif()
    if(NOT "slow" IN_LIST ARG_LABELS AND ("unit" IN_LIST ARG_LABELS OR "property" IN_LIST ARG_LABELS))
        add_dependencies(tests_fast ${name})
    endif()
endfunction()
