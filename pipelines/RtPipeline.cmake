# Chains of the tools as CMake targets. Each function makes a target NAME and files NAME.* in the current binary folder;
# NAME.json holds the tool's figures. A step runs where the content of one of the files that it reads, its options or its
# tool's version changed; a step whose output came out the same runs none of those after it. Comparisons run
# whenever CTest does.
#
#   rt_add_scene(NAME MODELS file... [ARGS ...])                                                   NAME.rtmesh
#   rt_add_atlas(NAME SCENE scene [STRUCTURE s] [QUALITY q] [RESOLUTION r] [ARGS ...])         NAME.rtatlas
#   rt_add_render(NAME ATLAS atlas SIZE WxH [CAMERA c] [FRAMES A-B] [SAMPLES n] [PASSES p...] [ARGS ...])
#                                           NAME.exr and NAME.png; with FRAMES NAME.0001.exr, ... and no NAME.exr
#   rt_add_query(NAME ATLAS atlas RAYS file [ARGS ...])                NAME.hits, what rt-trace --rays finds for these rays
#   rt_add_comparison(NAME A render B render [MAX_RMSE x] [ARGS ...])
#                                           a CTest test with NAME.json and NAME.html; of frames NAME.0001, ...
#   rt_add_regression(NAME RENDER render GOLDENS folder [MAX_RMSE x] [ARGS ...])
#                                           the same; the target update_goldens takes the renders for the goldens
#
# Ninja does not see a file that is replaced by an older one: touch the model; nor, in the folder that it builds in, a texture or
# material file that was missing and appears.
# Functions of one pipeline are called in one folder, in any order but that comparisons come behind their renders; this file is
# included there or above. A SCENE.rtmesh or ATLAS.rtatlas may also be there already, but from a step that is gone, or be made by a rule
# of that folder (OUTPUT, with Ninja BYPRODUCTS too) or by another target SCENE or ATLAS (which names it in BYPRODUCTS for Ninja); where
# nothing makes it CMake says so.
# RT_DEVICES, devices with commas between them as rt-trace --device takes them, renders frames side by side, one on each device at
# a time; what has no frames is the first device's. The device of `auto` is what the environment's RT_DEVICE says while it is built.
cmake_minimum_required(VERSION 3.25)

set(RT_TOOLS_DIR "" CACHE PATH "Folder with the tools; searched in PATH if empty")
set(RT_DEVICES "auto" CACHE STRING "Devices to render on, as rt-trace --device takes them, with commas between them")
# rt_find_tool(VARIABLE name): a program of that folder.
function(rt_find_tool variable name)
    set(only_there "")
    if(RT_TOOLS_DIR)
        set(only_there PATHS ${RT_TOOLS_DIR} NO_DEFAULT_PATH)
    endif()
    find_program(${variable} ${name} ${only_there} NO_CACHE)
    if(NOT ${variable})
        message(FATAL_ERROR "${name} is not in PATH or RT_TOOLS_DIR (${RT_TOOLS_DIR}).\n"
                            "Name the folder of the tools: -D RT_TOOLS_DIR=/path/to/build/release/bin")
    endif()
    set(${variable} ${${variable}} PARENT_SCOPE)
endfunction()

foreach(tool IN ITEMS import grid trace compare)
    string(TOUPPER RT_${tool} variable)
    rt_find_tool(${variable} rt-${tool})
endforeach()
enable_testing()
# In all folders above too, else ctest finds no tests from there; but where they have a target of the name that it takes.
macro(_rt_enable_testing)
    if(NOT TARGET test)
        enable_testing()
    endif()
endmacro()
get_property(_rt_above DIRECTORY PROPERTY PARENT_DIRECTORY)
while(_rt_above)
    cmake_language(EVAL CODE "cmake_language(DEFER DIRECTORY [[${_rt_above}]] CALL _rt_enable_testing)")
    get_property(_rt_above DIRECTORY ${_rt_above} PROPERTY PARENT_DIRECTORY)
endwhile()

# Import and grid use all cores: one at a time keeps memory low and measured times true. So does one step on a device.
get_property(_rt_pools GLOBAL PROPERTY JOB_POOLS) # has them if another folder includes this file too
string(REGEX REPLACE "[ ,;]+" ";" RT_DEVICES "${RT_DEVICES}")
list(REMOVE_ITEM RT_DEVICES "")
if(RT_DEVICES STREQUAL "")
    set(RT_DEVICES auto)
endif()
list(LENGTH RT_DEVICES _rt_device_count)
math(EXPR _rt_last_device "${_rt_device_count} - 1")
list(APPEND _rt_pools rt_tools=1)
foreach(device RANGE ${_rt_last_device})
    list(APPEND _rt_pools rt_device_${device}=1)
endforeach()
list(REMOVE_DUPLICATES _rt_pools)
set_property(GLOBAL PROPERTY JOB_POOLS ${_rt_pools})

# _rt_parse(ONE_VALUE LISTS REQUIRED ...): ARG_<key> for each key. ARGS is always one of the lists.
function(_rt_parse single lists required)
    if(NOT RT_IMPORT) # functions are known everywhere, the tools only there
        message(FATAL_ERROR "RtPipeline.cmake is included neither in this folder nor above it")
    endif()
    cmake_parse_arguments(PARSE_ARGV 3 ARG "" "${single}" "${lists};ARGS")
    list(REMOVE_ITEM ARG_KEYWORDS_MISSING_VALUES ${lists} ARGS) # lists may be empty
    if(ARG_UNPARSED_ARGUMENTS OR ARG_KEYWORDS_MISSING_VALUES)
        message(FATAL_ERROR "not understood: ${ARG_UNPARSED_ARGUMENTS} ${ARG_KEYWORDS_MISSING_VALUES}")
    endif()
    foreach(key IN LISTS required)
        if(NOT DEFINED ARG_${key})
            message(FATAL_ERROR "${key} is missing")
        endif()
    endforeach()
    foreach(key IN LISTS single lists ITEMS ARGS)
        set(ARG_${key} "${ARG_${key}}" PARENT_SCOPE)
    endforeach()
endfunction()

# _rt_step(NAME TOOL POOL OUTPUTS ... INPUTS ... ARGS ...): one call of a tool, one at a time in each pool.
function(_rt_step name tool pool)
    cmake_parse_arguments(PARSE_ARGV 3 STEP "" "" "OUTPUTS;INPUTS;ARGS")
    set(alone "")
    if(NOT CMAKE_GENERATOR MATCHES Ninja) # which has pools
        find_program(RT_FLOCK flock REQUIRED)
        mark_as_advanced(RT_FLOCK)
        set(alone ${RT_FLOCK} --no-fork ${CMAKE_BINARY_DIR}/${pool}.lock)
    endif()
    set(base ${CMAKE_CURRENT_BINARY_DIR}/${name})
    if(TEST ${name})
        message(FATAL_ERROR "${name} is a comparison already, which has the same files")
    endif()
    set_property(DIRECTORY APPEND PROPERTY RT_MADE ${STEP_OUTPUTS} ${base}.json)
    if(pool STREQUAL rt_tools AND NOT STEP_OUTPUTS IN_LIST RT_MADE_EVER)
        set(RT_MADE_EVER ${RT_MADE_EVER} ${STEP_OUTPUTS} CACHE INTERNAL "Meshes and atlases that steps of this folder ever made")
    endif()
    add_custom_command(
        OUTPUT ${STEP_OUTPUTS} ${base}.json
        COMMAND ${alone} ${tool} ${STEP_ARGS} --json ${base}.json --depfile ${base}.d
        DEPENDS ${STEP_INPUTS} ${tool}
        DEPFILE ${base}.d
        COMMENT "Making ${name}" JOB_POOL ${pool} VERBATIM)
endfunction()

# _rt_target(NAME MAKER SUFFIX file...): a target of these files, which are made of MAKER.SUFFIX; none if SUFFIX is empty.
function(_rt_target name maker suffix)
    add_custom_target(${name} ALL DEPENDS ${ARGN})
    set_target_properties(${name} PROPERTIES RT_FILES "${ARGN}")
    if(suffix) # what makes it may come later; the call gets the values of now
        cmake_language(EVAL CODE "cmake_language(DEFER DIRECTORY [[${CMAKE_SOURCE_DIR}]] CALL _rt_require
            [[${CMAKE_CURRENT_LIST_FILE}]] [[${name}]] [[${maker}]] [[${suffix}]] [[${CMAKE_CURRENT_BINARY_DIR}]])")
    endif()
endfunction()

# Properties: RT_FILES of a target of ours, what it makes; RT_MADE of a folder, what its steps make; RT_TOLD, files that nothing makes, as was
# said; RT_RENDERS, their names.

# Has NAME wait for the target MAKER. Refuses a MAKER.SUFFIX that is neither there nor made by a step or rule of its folder nor by
# a target of another kind.
function(_rt_require list_file name maker suffix folder)
    set(file ${folder}/${maker}.${suffix})
    get_source_file_property(is_made ${file} DIRECTORY ${folder} GENERATED)
    set(files ${file})
    if(TARGET ${maker})
        add_dependencies(${name} ${maker}) # Make, unlike Ninja, would make that twice
        get_target_property(files ${maker} RT_FILES)
    endif()
    get_property(told GLOBAL PROPERTY RT_TOLD)
    if(is_made OR NOT files OR file IN_LIST told)
        return()
    endif()
    if(EXISTS ${file} AND file IN_LIST RT_MADE_EVER)
        message(SEND_ERROR "${list_file}: ${name} needs ${file}, whose step is gone; remove that file, or keep it with -U RT_MADE_EVER")
        return()
    elseif(EXISTS ${file})
        message(NOTICE "${file} is taken as it is, since nothing makes it")
        set_property(GLOBAL APPEND PROPERTY RT_TOLD ${file})
        return()
    endif()
    get_property(made DIRECTORY ${folder} PROPERTY RT_MADE)
    list(FILTER made INCLUDE REGEX "\\.${suffix}$")
    list(TRANSFORM made REPLACE "^.*/" "")
    list(JOIN made ", " made)
    if(made STREQUAL "")
        set(made none)
    endif()
    message(SEND_ERROR "${list_file}: ${name} needs ${maker}.${suffix}, which nothing makes in ${folder}; known there: ${made}")
endfunction()

# Sets `options` to those that choose a device.
function(_rt_device options device)
    list(GET RT_DEVICES ${device} name)
    set(${options} --device ${name} PARENT_SCOPE)
    if(name STREQUAL "auto")
        set(${options} "" PARENT_SCOPE)
    endif()
endfunction()

function(rt_add_scene name)
    _rt_parse("" "MODELS" "MODELS" ${ARGN})
    set(models "") # the caller may have such a variable
    foreach(model IN LISTS ARG_MODELS)
        cmake_path(ABSOLUTE_PATH model BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
        list(APPEND models ${model})
    endforeach()
    set(mesh ${CMAKE_CURRENT_BINARY_DIR}/${name}.rtmesh)
    _rt_step(${name} ${RT_IMPORT} rt_tools OUTPUTS ${mesh} INPUTS ${models} ARGS ${models} -o ${mesh} --if-changed ${ARG_ARGS})
    _rt_target(${name} "" "" ${mesh})
endfunction()

function(rt_add_atlas name)
    _rt_parse("SCENE;STRUCTURE;QUALITY;RESOLUTION" "" "SCENE" ${ARGN})
    set(mesh ${CMAKE_CURRENT_BINARY_DIR}/${ARG_SCENE}.rtmesh)
    set(atlas ${CMAKE_CURRENT_BINARY_DIR}/${name}.rtatlas)
    foreach(option IN ITEMS STRUCTURE QUALITY RESOLUTION)
        if(NOT ARG_${option} STREQUAL "")
            string(TOLOWER ${option} flag)
            list(PREPEND ARG_ARGS --${flag} ${ARG_${option}})
        endif()
    endforeach()
    _rt_step(${name} ${RT_GRID} rt_tools OUTPUTS ${atlas} INPUTS ${mesh} ARGS ${mesh} -o ${atlas} --if-changed ${ARG_ARGS})
    _rt_target(${name} ${ARG_SCENE} rtmesh ${atlas})
endfunction()

# One step for each frame: those that did not change are skipped, and several devices share them. --reproducible: a picture
# that came out the same keeps its time stamp; times are in the .json.
function(rt_add_render name)
    _rt_parse("ATLAS;SIZE;CAMERA;FRAMES;SAMPLES" "PASSES" "ATLAS;SIZE" ${ARGN})
    set(options --size ${ARG_SIZE} --stats --reproducible --if-changed ${ARG_ARGS})
    set(files "")
    if(NOT ARG_CAMERA STREQUAL "")
        list(APPEND options --camera ${ARG_CAMERA})
    endif()
    if(NOT ARG_SAMPLES STREQUAL "")
        list(APPEND options --spp ${ARG_SAMPLES})
    endif()
    if(NOT ARG_PASSES STREQUAL "")
        list(JOIN ARG_PASSES "," passes)
        list(APPEND options --aov ${passes})
    endif()
    if(ARG_FRAMES STREQUAL "")
        _rt_picture(files ${name} ${ARG_ATLAS} 0 ${options})
    elseif(ARG_FRAMES MATCHES "^([0-9]+)(-([0-9]+))?$")
        set(first ${CMAKE_MATCH_1})
        set(last ${CMAKE_MATCH_${CMAKE_MATCH_COUNT}}) # the same if there is but one
        if(last LESS first)
            message(FATAL_ERROR "FRAMES ${ARG_FRAMES}: the last frame is before the first")
        endif()
        foreach(frame RANGE ${first} ${last})
            math(EXPR device "(${frame} - ${first}) % ${_rt_device_count}")
            string(REGEX REPLACE ".*(....)$" "\\1" padded 000${frame})
            if(frame GREATER 9999)
                set(padded ${frame})
            endif()
            _rt_picture(file ${name}.${padded} ${ARG_ATLAS} ${device} ${options} --frames ${frame})
            list(APPEND files ${file})
        endforeach()
    else()
        message(FATAL_ERROR "FRAMES ${ARG_FRAMES}: not a range such as 1-48")
    endif()
    _rt_target(${name} ${ARG_ATLAS} rtatlas ${files})
    set_property(GLOBAL APPEND PROPERTY RT_RENDERS ${name})
endfunction()

# One step of rt-trace; sets `file` to its EXR.
function(_rt_picture file name atlas device)
    set(base ${CMAKE_CURRENT_BINARY_DIR}/${name})
    set(atlas_file ${CMAKE_CURRENT_BINARY_DIR}/${atlas}.rtatlas)
    _rt_device(device_options ${device})
    _rt_step(${name} ${RT_TRACE} rt_device_${device} OUTPUTS ${base}.exr ${base}.png INPUTS ${atlas_file}
             ARGS ${atlas_file} -o ${base}.exr -o ${base}.png ${device_options} ${ARGN})
    set(${file} ${base}.exr PARENT_SCOPE)
endfunction()

function(rt_add_query name)
    _rt_parse("ATLAS;RAYS" "" "ATLAS;RAYS" ${ARGN})
    cmake_path(ABSOLUTE_PATH ARG_RAYS BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    set(hits ${CMAKE_CURRENT_BINARY_DIR}/${name}.hits)
    set(atlas ${CMAKE_CURRENT_BINARY_DIR}/${ARG_ATLAS}.rtatlas)
    _rt_device(device_options 0)
    _rt_step(${name} ${RT_TRACE} rt_device_0 OUTPUTS ${hits} INPUTS ${atlas} ${ARG_RAYS}
             ARGS ${atlas} --rays ${ARG_RAYS} -o ${hits} --if-changed ${device_options} ${ARG_ARGS})
    _rt_target(${name} ${ARG_ATLAS} rtatlas ${hits})
endfunction()

function(rt_add_comparison name)
    _rt_parse("A;B;MAX_RMSE" "" "A;B" ${ARGN})
    _rt_files_of(b ${ARG_B})
    _rt_compare(${name} ${ARG_A} "${b}" "${ARG_MAX_RMSE}" ${ARG_ARGS})
endfunction()

# Goldens have the names of the pictures.
function(rt_add_regression name)
    _rt_parse("RENDER;GOLDENS;MAX_RMSE" "" "RENDER;GOLDENS" ${ARGN})
    cmake_path(ABSOLUTE_PATH ARG_GOLDENS BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    _rt_files_of(files ${ARG_RENDER})
    list(TRANSFORM files REPLACE "^.*/" "${ARG_GOLDENS}/" OUTPUT_VARIABLE goldens)
    _rt_compare(${name} ${ARG_RENDER} "${goldens}" "${ARG_MAX_RMSE}" ${ARG_ARGS})
    add_custom_target(update_${name}
        COMMAND ${CMAKE_COMMAND} -E make_directory ${ARG_GOLDENS}
        COMMAND ${CMAKE_COMMAND} -E copy_if_different ${files} ${ARG_GOLDENS}
        DEPENDS ${files} COMMENT "Taking ${ARG_RENDER} for ${ARG_GOLDENS}" VERBATIM)
    add_dependencies(update_${name} ${ARG_RENDER})
    if(NOT TARGET update_goldens)
        add_custom_target(update_goldens)
    endif()
    set_target_properties(update_${name} update_goldens PROPERTIES RT_FILES ${ARG_GOLDENS}) # so that ATLAS update_... is refused
    add_dependencies(update_goldens update_${name})
endfunction()

# A test for each picture, with further options of rt-compare.
function(_rt_compare name render references max_rmse)
    _rt_files_of(files ${render})
    get_property(made DIRECTORY PROPERTY RT_MADE)
    list(LENGTH files count)
    list(LENGTH references wanted)
    string(LENGTH ${render} render_length)
    if(NOT count EQUAL wanted)
        message(FATAL_ERROR "${name}: ${render} has ${count} pictures, ${wanted} are to be compared with")
    endif()
    set(options ${ARGN})
    if(NOT max_rmse STREQUAL "")
        list(PREPEND options --max-rmse ${max_rmse})
    endif()
    foreach(picture reference IN ZIP_LISTS files references)
        cmake_path(GET picture STEM LAST_ONLY stem)
        string(SUBSTRING ${stem} ${render_length} -1 number) # .0001, or nothing
        set(test ${name}${number})
        set(base ${CMAKE_CURRENT_BINARY_DIR}/${test})
        if("${base}.json" IN_LIST made)
            message(FATAL_ERROR "${test} is a step already, whose files a comparison of that name would replace")
        endif()
        file(REAL_PATH ${picture} picture_path)
        file(REAL_PATH ${reference} reference_path)
        if(picture_path STREQUAL reference_path)
            message(FATAL_ERROR "${name}: ${picture} would be compared with itself")
        endif()
        add_test(NAME ${test} COMMAND ${RT_COMPARE} ${picture} ${reference} --json ${base}.json --html ${base}.html ${options})
    endforeach()
endfunction()

# Sets `files` to the EXR files of a render.
function(_rt_files_of files render)
    get_property(renders GLOBAL PROPERTY RT_RENDERS)
    if(NOT render IN_LIST renders)
        list(JOIN renders ", " renders)
        message(FATAL_ERROR "${render} is no rt_add_render() above this call; there are: ${renders}")
    endif()
    get_target_property(of_render ${render} RT_FILES)
    set(${files} ${of_render} PARENT_SCOPE)
endfunction()
