# teem and nifticlib are the other implementations that the readers are checked against.
find_library(BRACE_TEEM_LIBRARY teem REQUIRED)
find_library(BRACE_NIFTIIO_LIBRARY niftiio REQUIRED)
find_path(BRACE_NIFTIIO_INCLUDE znzlib.h PATH_SUFFIXES nifti REQUIRED)
brace_test(volume_test LABEL unit
  LIBRARIES brace::volume ${BRACE_TEEM_LIBRARY} ${BRACE_NIFTIIO_LIBRARY} ZLIB::ZLIB
  SOURCES
    ${CMAKE_CURRENT_LIST_DIR}/volume/allocations.cpp
    ${CMAKE_CURRENT_LIST_DIR}/volume/generators_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/volume/malformed_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/volume/meta_image_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/volume/nifti_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/volume/nrrd_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/volume/raw_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/volume/real_volumes_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/volume/statistics_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/volume/streaming_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/volume/support.cpp
    ${CMAKE_CURRENT_LIST_DIR}/volume/transfer_function_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/volume/write_transfer_function_test.cpp)
target_include_directories(volume_test SYSTEM PRIVATE ${BRACE_NIFTIIO_INCLUDE})
target_compile_definitions(volume_test PRIVATE BRACE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
