# The targets of sscc for a build or an installation, given by SSCC_INCLUDE_DIR, SSCC_LIBRARY_DIR, SSCC_SHARED and SSCC_LINK.
if(NOT TARGET sscc::sscc)
  add_library(sscc::sscc_shared SHARED IMPORTED GLOBAL)
  set_target_properties(sscc::sscc_shared PROPERTIES
    IMPORTED_LOCATION "${SSCC_LIBRARY_DIR}/${SSCC_SHARED}"
    IMPORTED_SONAME "${SSCC_SHARED}"
    INTERFACE_INCLUDE_DIRECTORIES "${SSCC_INCLUDE_DIR}")
  # The system libraries that the static library needs.
  add_library(sscc::sscc_static STATIC IMPORTED GLOBAL)
  set_target_properties(sscc::sscc_static PROPERTIES
    IMPORTED_LOCATION "${SSCC_LIBRARY_DIR}/libsscc.a"
    INTERFACE_INCLUDE_DIRECTORIES "${SSCC_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "Threads::Threads;${CMAKE_DL_LIBS};m")
  add_library(sscc::sscc INTERFACE IMPORTED GLOBAL)
  if(SSCC_STATIC)
    set_target_properties(sscc::sscc PROPERTIES INTERFACE_LINK_LIBRARIES sscc::sscc_static)
  else()
    set_target_properties(sscc::sscc PROPERTIES INTERFACE_LINK_LIBRARIES sscc::sscc_shared)
  endif()
endif()
