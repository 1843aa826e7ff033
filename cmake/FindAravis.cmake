# Finds Aravis 0.8 and defines Aravis::Aravis. Does not use aravis-0.8.pc: Debian's requires libusb's development files, which
# Atrium does not need.
find_package(PkgConfig REQUIRED)
pkg_check_modules(ARAVIS_GLIB IMPORTED_TARGET GLOBAL gio-2.0 gobject-2.0)
find_path(ARAVIS_INCLUDE_DIR arv.h PATH_SUFFIXES aravis-0.8)
find_library(ARAVIS_LIBRARY aravis-0.8)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Aravis REQUIRED_VARS ARAVIS_LIBRARY ARAVIS_INCLUDE_DIR ARAVIS_GLIB_FOUND)
if(Aravis_FOUND AND NOT TARGET Aravis::Aravis)
    add_library(Aravis::Aravis UNKNOWN IMPORTED GLOBAL)
    set_target_properties(Aravis::Aravis PROPERTIES
        IMPORTED_LOCATION ${ARAVIS_LIBRARY}
        INTERFACE_INCLUDE_DIRECTORIES ${ARAVIS_INCLUDE_DIR}
        INTERFACE_LINK_LIBRARIES PkgConfig::ARAVIS_GLIB)
endif()
mark_as_advanced(ARAVIS_INCLUDE_DIR ARAVIS_LIBRARY)
