# find_package(joulepath) after `make install`: the target joulepath::joulepath.
if(NOT TARGET joulepath::joulepath)
  get_filename_component(_joulepath_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
  add_library(joulepath::joulepath STATIC IMPORTED)
  set_target_properties(joulepath::joulepath PROPERTIES
    IMPORTED_LOCATION "${_joulepath_prefix}/lib/libjoulepath.a"
    IMPORTED_LINK_INTERFACE_LANGUAGES C
    INTERFACE_INCLUDE_DIRECTORIES "${_joulepath_prefix}/include")
  unset(_joulepath_prefix)
endif()
