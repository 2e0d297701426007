# What the pipelines of real scenes have in common; included after RtPipeline.cmake.
set(RT_SCENES_DIR "$ENV{RT_SCENES_DIR}" CACHE PATH "Folder with models/ and images/")
if(NOT RT_SCENES_DIR)
    set(RT_SCENES_DIR ${CMAKE_CURRENT_LIST_DIR}/../../shared/scenes)
endif()

# RT_SOFTWARE: whether the first device is a software renderer, which shows that everything works, not how fast it is.
execute_process(COMMAND ${RT_TRACE} --list-devices OUTPUT_VARIABLE _rt_devices COMMAND_ERROR_IS_FATAL ANY)
list(GET RT_DEVICES 0 _rt_device)
set(RT_SOFTWARE OFF)
if(_rt_device STREQUAL software OR NOT _rt_devices MATCHES "[0-9] +hardware" OR _rt_devices MATCHES "(^|\n)${_rt_device} +software")
    set(RT_SOFTWARE ON)
endif()
