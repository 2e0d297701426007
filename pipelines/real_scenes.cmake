# What the pipelines of real scenes have in common; included after RtPipeline.cmake.
set(RT_SCENES_DIR "$ENV{RT_SCENES_DIR}" CACHE PATH "Folder with models/ and images/")
if(NOT RT_SCENES_DIR)
    unset(RT_SCENES_DIR CACHE) # the environment is asked again the next time
endif()

# rt_skip_scene(NAME file...): says that a scene is left out, without these files.
function(rt_skip_scene scene)
    list(JOIN ARGN " and " why)
    if(NOT RT_SCENES_DIR)
        set(why "models and images: set RT_SCENES_DIR, or -D RT_SCENES_DIR=/path/to/folder, to where they are")
    endif()
    message(NOTICE "${scene}: skipped, without ${why}")
endfunction()

# RT_SOFTWARE: whether the first device is a software renderer, which shows that everything works, not how fast it is.
execute_process(COMMAND ${RT_TRACE} --list-devices --json - OUTPUT_VARIABLE _rt_json COMMAND_ERROR_IS_FATAL ANY)
list(GET RT_DEVICES 0 _rt_device)
set(RT_SOFTWARE ON)
string(JSON _rt_left LENGTH "${_rt_json}" devices)
while(_rt_left)
    math(EXPR _rt_left "${_rt_left} - 1")
    string(JSON _rt_entry GET "${_rt_json}" devices ${_rt_left})
    string(JSON _rt_problem ERROR_VARIABLE _rt_works GET "${_rt_entry}" problem)
    string(JSON _rt_is_software GET "${_rt_entry}" software)
    string(JSON _rt_cuda ERROR_VARIABLE _rt_no_cuda GET "${_rt_entry}" cudaDevice)
    set(_rt_names auto ${_rt_left} cuda:${_rt_cuda}) # as RT_DEVICES calls it
    if(_rt_works AND NOT _rt_is_software AND _rt_device IN_LIST _rt_names)
        set(RT_SOFTWARE OFF)
    endif()
endwhile()

# rt_set_size(VARIABLE full reduced "what it is"): a variable of the cache whose default the option RT_REDUCED chooses.
function(rt_set_size variable full reduced what)
    option(RT_REDUCED "Small scenes and pictures, few passes" ${RT_SOFTWARE})
    set(default "${full}")
    if(RT_REDUCED)
        set(default "${reduced}")
    endif()
    set(${variable} "${default}" CACHE STRING "${what}")
endfunction()
