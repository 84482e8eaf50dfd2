# libdeflate: deflate of whole buffers, the same bytes for the same input.
# Defines the target LibDeflate::LibDeflate.
find_path(LIBDEFLATE_INCLUDE_DIR libdeflate.h)
find_library(LIBDEFLATE_LIBRARY deflate)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(LibDeflate REQUIRED_VARS LIBDEFLATE_LIBRARY LIBDEFLATE_INCLUDE_DIR
    REASON_FAILURE_MESSAGE "install libdeflate-dev")
if(LibDeflate_FOUND AND NOT TARGET LibDeflate::LibDeflate)
    add_library(LibDeflate::LibDeflate INTERFACE IMPORTED)
    set_target_properties(LibDeflate::LibDeflate PROPERTIES
        INTERFACE_INCLUDE_DIRECTORIES "${LIBDEFLATE_INCLUDE_DIR}" INTERFACE_LINK_LIBRARIES "${LIBDEFLATE_LIBRARY}")
endif()
mark_as_advanced(LIBDEFLATE_INCLUDE_DIR LIBDEFLATE_LIBRARY)
