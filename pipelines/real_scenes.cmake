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
string(JSON _rt_left LENGTH "${_rt_json}" devices)
set(_rt_hardware "") # what RT_DEVICES may call one that works
while(_rt_left)
    math(EXPR _rt_left "${_rt_left} - 1")
    string(JSON _rt_entry GET "${_rt_json}" devices ${_rt_left})
    string(JSON _rt_problem ERROR_VARIABLE _rt_works GET "${_rt_entry}" problem)
    string(JSON _rt_is_software GET "${_rt_entry}" software)
    if(_rt_works AND NOT _rt_is_software)
        string(JSON _rt_index GET "${_rt_entry}" index)
        string(JSON _rt_cuda GET "${_rt_entry}" cudaDevice)
        list(APPEND _rt_hardware auto ${_rt_index} cuda:${_rt_cuda})
    endif()
endwhile()
list(GET RT_DEVICES 0 _rt_device)
set(RT_SOFTWARE ON)
if(_rt_device IN_LIST _rt_hardware)
    set(RT_SOFTWARE OFF)
endif()
