# wire_types(dependency ...): generate all messages, services and actions of the project.
# Every package of compat/ is built by this; tools/set_up.py calls it.
# Definitions that differ between distributions are in folders of their own, of which the variable
# WIRE_TYPES_VARIANT names one.

if(NOT CMAKE_CXX_STANDARD)
  set(CMAKE_CXX_STANDARD 17)
endif()

macro(wire_types)
  find_package(ament_cmake REQUIRED)
  find_package(rosidl_default_generators REQUIRED)
  foreach(dependency ${ARGN})
    find_package(${dependency} REQUIRED)
  endforeach()

  # Include directories of the machine or the environment that built the packages, which CMake refuses
  # where they do not exist; see robomech_interfaces/CMakeLists.txt.
  get_property(imported_targets DIRECTORY PROPERTY IMPORTED_TARGETS)
  foreach(target IN LISTS imported_targets)
    get_target_property(directories ${target} INTERFACE_INCLUDE_DIRECTORIES)
    set(existing ${directories})
    foreach(directory IN LISTS directories)
      if(IS_ABSOLUTE "${directory}" AND NOT EXISTS "${directory}")
        list(REMOVE_ITEM existing "${directory}")
      endif()
    endforeach()
    if(directories)
      set_target_properties(${target} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${existing}")
    endif()
  endforeach()

  file(GLOB definitions RELATIVE ${PROJECT_SOURCE_DIR}
    ${PROJECT_SOURCE_DIR}/msg/*.msg
    ${PROJECT_SOURCE_DIR}/srv/*.srv
    ${PROJECT_SOURCE_DIR}/action/*.action
  )
  if(WIRE_TYPES_VARIANT)
    set(variant ${PROJECT_SOURCE_DIR}/${WIRE_TYPES_VARIANT})
    file(GLOB varying RELATIVE ${variant} ${variant}/*/*.msg ${variant}/*/*.srv ${variant}/*/*.action)
    list(TRANSFORM varying PREPEND ${variant}:)
    list(APPEND definitions ${varying})
  endif()
  # Neither types for C++ nor long optimisation, as in the wheel of robomech_interfaces.
  list(FILTER AMENT_EXTENSIONS_rosidl_generate_idl_interfaces EXCLUDE REGEX "_cpp:")
  set(CMAKE_C_FLAGS_RELEASE "-O1 -DNDEBUG")
  set(CMAKE_CXX_FLAGS_RELEASE "-O1 -DNDEBUG")
  rosidl_generate_interfaces(${PROJECT_NAME} ${definitions} DEPENDENCIES ${ARGN})

  # Forty files in one run of the compiler; see robomech_interfaces/CMakeLists.txt.
  foreach(part generator_c generator_py typesupport_c typesupport_fastrtps_c
      typesupport_introspection_c)
    set(target ${PROJECT_NAME}__rosidl_${part})
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 40)
    get_target_property(files ${target} SOURCES)
    list(FILTER files INCLUDE REGEX "__description\\.c$")
    set_source_files_properties(${files} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endforeach()
  ament_export_dependencies(rosidl_default_runtime)
  ament_package()
endmacro()
