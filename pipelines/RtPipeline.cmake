# Chains of the tools as CMake/Ninja targets. Each function makes a target NAME and files NAME.* in the current binary
# folder; NAME.json holds the tool's figures. Steps depend on the files and on the tools that they use; a step whose
# output did not change does not run those after it.
#
#   rt_add_scene(NAME MODEL file [ARGS ...])                                                NAME.rtmesh
#   rt_add_atlas(NAME SCENE scene [STRUCTURE s] [QUALITY q] [RESOLUTION r] [ARGS ...]) NAME.rtatlas
#   rt_add_render(NAME ATLAS atlas SIZE WxH [ARGS ...])                                     NAME.exr, NAME.png
#   rt_add_comparison(NAME A render B render MAX_RMSE x [ARGS ...])                         fails if they differ
cmake_minimum_required(VERSION 3.25)

set(RT_TOOLS_DIR "" CACHE PATH "Folder with the tools; searched in PATH if empty")
foreach(tool IN ITEMS import grid trace compare)
    string(TOUPPER RT_${tool} variable)
    if(RT_TOOLS_DIR)
        find_program(${variable} rt-${tool} PATHS ${RT_TOOLS_DIR} NO_DEFAULT_PATH REQUIRED)
    else()
        find_program(${variable} rt-${tool} REQUIRED)
    endif()
endforeach()

# Every tool uses all cores: one at a time keeps memory low and measured times true.
set_property(GLOBAL APPEND PROPERTY JOB_POOLS rt_tools=1)

function(_rt_parse)
    cmake_parse_arguments(PARSE_ARGV 2 ARG "" "${ARGV0}" "ARGS")
    if(ARG_UNPARSED_ARGUMENTS OR ARG_KEYWORDS_MISSING_VALUES)
        message(FATAL_ERROR "not understood: ${ARG_UNPARSED_ARGUMENTS} ${ARG_KEYWORDS_MISSING_VALUES}")
    endif()
    foreach(key IN LISTS ARGV1)
        if(NOT DEFINED ARG_${key})
            message(FATAL_ERROR "${key} is missing")
        endif()
    endforeach()
    foreach(key IN LISTS ARGV0 ITEMS ARGS)
        set(ARG_${key} "${ARG_${key}}" PARENT_SCOPE)
    endforeach()
endfunction()

function(rt_add_scene name)
    _rt_parse("MODEL" "MODEL" ${ARGN})
    cmake_path(ABSOLUTE_PATH ARG_MODEL BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    set(base ${CMAKE_CURRENT_BINARY_DIR}/${name})
    add_custom_command(
        OUTPUT ${base}.rtmesh ${base}.json
        COMMAND ${RT_IMPORT} ${ARG_MODEL} -o ${base}.rtmesh --depfile ${base}.d --json ${base}.json ${ARG_ARGS}
        DEPENDS ${ARG_MODEL} ${RT_IMPORT}
        DEPFILE ${base}.d
        COMMENT "Importing ${name}" JOB_POOL rt_tools VERBATIM)
    add_custom_target(${name} ALL DEPENDS ${base}.rtmesh ${base}.json)
endfunction()

function(rt_add_atlas name)
    _rt_parse("SCENE;STRUCTURE;QUALITY;RESOLUTION" "SCENE" ${ARGN})
    set(base ${CMAKE_CURRENT_BINARY_DIR}/${name})
    set(mesh ${CMAKE_CURRENT_BINARY_DIR}/${ARG_SCENE}.rtmesh)
    foreach(option IN ITEMS STRUCTURE QUALITY RESOLUTION)
        if(ARG_${option})
            string(TOLOWER ${option} flag)
            list(PREPEND ARG_ARGS --${flag} ${ARG_${option}})
        endif()
    endforeach()
    add_custom_command(
        OUTPUT ${base}.rtatlas ${base}.json
        COMMAND ${RT_GRID} ${mesh} -o ${base}.rtatlas --json ${base}.json ${ARG_ARGS}
        DEPENDS ${mesh} ${RT_GRID}
        COMMENT "Gridding ${name}" JOB_POOL rt_tools VERBATIM)
    add_custom_target(${name} ALL DEPENDS ${base}.rtatlas ${base}.json)
endfunction()

# --reproducible: a picture that came out the same keeps its time stamp; times are in NAME.json.
function(rt_add_render name)
    _rt_parse("ATLAS;SIZE" "ATLAS;SIZE" ${ARGN})
    set(base ${CMAKE_CURRENT_BINARY_DIR}/${name})
    set(atlas ${CMAKE_CURRENT_BINARY_DIR}/${ARG_ATLAS}.rtatlas)
    add_custom_command(
        OUTPUT ${base}.exr ${base}.png ${base}.json
        COMMAND ${RT_TRACE} ${atlas} -o ${base}.exr -o ${base}.png --size ${ARG_SIZE} --stats --reproducible
                --json ${base}.json ${ARG_ARGS}
        DEPENDS ${atlas} ${RT_TRACE}
        COMMENT "Rendering ${name}" JOB_POOL rt_tools VERBATIM)
    add_custom_target(${name} ALL DEPENDS ${base}.exr ${base}.png ${base}.json)
endfunction()

# Ninja takes any new output for a success: the report gets its name only once the comparison has passed.
function(rt_add_comparison name)
    _rt_parse("A;B;MAX_RMSE" "A;B;MAX_RMSE" ${ARGN})
    set(base ${CMAKE_CURRENT_BINARY_DIR}/${name})
    set(a ${CMAKE_CURRENT_BINARY_DIR}/${ARG_A}.exr)
    set(b ${CMAKE_CURRENT_BINARY_DIR}/${ARG_B}.exr)
    add_custom_command(
        OUTPUT ${base}.json
        COMMAND ${RT_COMPARE} ${a} ${b} --max-rmse ${ARG_MAX_RMSE} --json ${base}.unchecked.json ${ARG_ARGS}
        COMMAND ${CMAKE_COMMAND} -E rename ${base}.unchecked.json ${base}.json
        DEPENDS ${a} ${b} ${RT_COMPARE}
        COMMENT "Comparing ${ARG_A} with ${ARG_B}" JOB_POOL rt_tools VERBATIM)
    add_custom_target(${name} ALL DEPENDS ${base}.json)
endfunction()
