# What every target of the project has in common: language, warnings, sanitizers.
include_guard()

function(sateen_target_settings target)
    target_compile_features(${target} PUBLIC cxx_std_20)
    set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
    # Contraction to fused multiply-add would make results depend on the target.
    target_compile_options(${target} PRIVATE -ffp-contract=off)
    if(SATEEN_DEVELOPER)
        target_compile_options(${target} PRIVATE
            -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wold-style-cast
            -Wdouble-promotion -Wnon-virtual-dtor -Werror)
    endif()
    if(SATEEN_SANITIZE)
        target_compile_options(${target} PRIVATE -fsanitize=${SATEEN_SANITIZE}
            -fno-omit-frame-pointer -fno-sanitize-recover=undefined)
        target_compile_definitions(${target} PRIVATE _GLIBCXX_ASSERTIONS)
        string(REPLACE "fuzzer-no-link," "" link_sanitize "${SATEEN_SANITIZE}")
        target_link_options(${target} PUBLIC -fsanitize=${link_sanitize})
    endif()
endfunction()

# sateen_library(core SOURCES a.cpp ... [PUBLIC sateen::x ...] [PRIVATE lib ...])
function(sateen_library name)
    cmake_parse_arguments(arg "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
    add_library(sateen_${name} STATIC ${arg_SOURCES})
    add_library(sateen::${name} ALIAS sateen_${name})
    target_include_directories(sateen_${name} PUBLIC
        $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>)
    target_include_directories(sateen_${name} PRIVATE ${PROJECT_SOURCE_DIR}/src)
    target_link_libraries(sateen_${name} PUBLIC ${arg_PUBLIC} PRIVATE ${arg_PRIVATE})
    sateen_target_settings(sateen_${name})
endfunction()

# sateen_test(core SOURCES a_test.cpp ... LIBRARIES sateen::core ... LABELS unit)
function(sateen_test name)
    cmake_parse_arguments(arg "" "" "SOURCES;LIBRARIES;LABELS" ${ARGN})
    add_executable(${name}_test ${arg_SOURCES})
    target_include_directories(${name}_test PRIVATE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR}/tests)
    target_link_libraries(${name}_test PRIVATE ${arg_LIBRARIES} GTest::gtest_main GTest::gmock)
    sateen_target_settings(${name}_test)
    add_test(NAME ${name} COMMAND ${name}_test)
    set_tests_properties(${name} PROPERTIES LABELS "${arg_LABELS}" TIMEOUT 900)
endfunction()

# sateen_bench(fft SOURCES fft_bench.cpp LIBRARIES ...)
function(sateen_bench name)
    cmake_parse_arguments(arg "" "" "SOURCES;LIBRARIES" ${ARGN})
    add_executable(${name}_bench ${arg_SOURCES})
    target_include_directories(${name}_bench PRIVATE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR}/tests
        ${PROJECT_SOURCE_DIR}/bench)
    target_link_libraries(${name}_bench PRIVATE ${arg_LIBRARIES})
    sateen_target_settings(${name}_bench)
    set_target_properties(${name}_bench PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bench)
endfunction()
