# find_package(joulepath) after `make install`: the targets joulepath::joulepath and joulepath::float.
if(NOT TARGET joulepath::joulepath)
  get_filename_component(_joulepath_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
  add_library(joulepath::joulepath STATIC IMPORTED)
  set_target_properties(joulepath::joulepath PROPERTIES
    IMPORTED_LOCATION "${_joulepath_prefix}/lib/libjoulepath.a"
    IMPORTED_LINK_INTERFACE_LANGUAGES C
    INTERFACE_INCLUDE_DIRECTORIES "${_joulepath_prefix}/include")
  add_library(joulepath::float STATIC IMPORTED)
  set_target_properties(joulepath::float PROPERTIES
    IMPORTED_LOCATION "${_joulepath_prefix}/lib/libjoulepath_float.a"
    IMPORTED_LINK_INTERFACE_LANGUAGES C
    INTERFACE_LINK_LIBRARIES joulepath::joulepath)
  unset(_joulepath_prefix)
endif()
