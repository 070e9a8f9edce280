# Settings of the WebAssembly build, which emcmake configures. The headers that the runtime
# needs come from the distribution's native packages, through a folder of links of our own:
# with all of /usr/include on its path the cross compiler would take the wrong C library.
include_guard()

set(SATEEN_WASM_HEADERS ${PROJECT_BINARY_DIR}/headers)
file(MAKE_DIRECTORY ${SATEEN_WASM_HEADERS})
foreach(library hwy flatbuffers)
    if(NOT EXISTS /usr/include/${library})
        message(FATAL_ERROR "/usr/include/${library} is missing: install libhwy-dev and libflatbuffers-dev")
    endif()
    file(CREATE_LINK /usr/include/${library} ${SATEEN_WASM_HEADERS}/${library} SYMBOLIC)
endforeach()
set(SATEEN_FLATBUFFERS_INCLUDE ${SATEEN_WASM_HEADERS} CACHE PATH "Links to headers" FORCE)

# find_package(hwy) finds the header-only library here.
file(WRITE ${PROJECT_BINARY_DIR}/hwy/hwy-config.cmake
    "if(NOT TARGET hwy::hwy)\n"
    "  add_library(hwy::hwy INTERFACE IMPORTED)\n"
    "  set_target_properties(hwy::hwy PROPERTIES INTERFACE_INCLUDE_DIRECTORIES ${SATEEN_WASM_HEADERS})\n"
    "endif()\n")
set(hwy_DIR ${PROJECT_BINARY_DIR}/hwy CACHE PATH "Header-only Highway" FORCE)

add_compile_definitions(SATEEN_STATIC_DISPATCH)
# clang 14 takes for ever over the ten rounds of Philox once they are unrolled.
add_compile_options(-msimd128 -fno-exceptions -fno-rtti -fno-unroll-loops)
add_link_options(-msimd128 -fno-exceptions)
