# Every triangle test in every precision, measured against the exact one through the first variant: rays through all variants,
# pictures through the first.
set(exact --intersect watertight --precision double)

function(start_tables scene)
    set(case scene,structure,options,intersect,precision)
    file(WRITE ${out}/${scene}.errors.csv "${case},set,atlas,step\n")
    file(WRITE ${out}/${scene}.pictures.csv "${case},spp,width,height,atlas,step\n")
endfunction()

function(measure scene atlas case is_first)
    list(TRANSFORM ARGN REPLACE "^--target" "--look-at" OUTPUT_VARIABLE view) # for rt-trace
    if(is_first)
        list(GET RT_SPP_SIDES -1 most)
        add_picture(${scene} ${atlas} ${scene}-reference ${most} ${view} ${exact})
        foreach(ray_set IN LISTS RT_SETS)
            add_query(${scene} ${atlas} ${scene}-reference-${ray_set} ${ray_set} ${exact})
        endforeach()
    endif()
    foreach(intersect IN LISTS RT_INTERSECTS)
        foreach(precision IN LISTS RT_PRECISIONS)
            set(name ${intersect}-${precision})
            set(options --intersect ${intersect} --precision ${precision} ${repeat_option})
            measure_rays(${scene} ${atlas} "${case},${intersect},${precision}" ${name} ${options})
            if(is_first)
                measure_pictures(${scene} ${atlas} "${case},${intersect},${precision}" ${name} ${view} ${options})
            endif()
        endforeach()
    endforeach()
endfunction()

function(measure_rays scene atlas case name)
    foreach(ray_set IN LISTS RT_SETS)
        set(step ${atlas}-${ray_set}-${name})
        add_query(${scene} ${atlas} ${step} ${ray_set} ${ARGN})
        compare_step(${scene} ${step} ${scene}-reference-${ray_set}.hits ${step}.hits COMMAND ${RT_MEASURE_HITS}
                     --rays ${scene}/${ray_set}.rays --mesh ${scene}.rtmesh -q)
        file(APPEND ${out}/${scene}.errors.csv "${case},${ray_set},${atlas},${step}\n")
    endforeach()
endfunction()

function(measure_pictures scene atlas case name)
    foreach(side IN LISTS RT_SPP_SIDES)
        math(EXPR spp "${side} * ${side}")
        set(step ${scene}-picture-${name}-${spp}spp)
        add_picture(${scene} ${atlas} ${step} ${side} ${ARGN})
        compare_step(${scene} ${step} ${step}-small.exr ${scene}-reference-small.exr COMMAND ${RT_COMPARE}
                     --max-rmse *=1e30 -q) # figures, no verdict
        file(APPEND ${out}/${scene}.pictures.csv "${case},${spp},${RT_PICTURE_SIZE},${RT_PICTURE_SIZE},${atlas},${step}\n")
    endforeach()
endfunction()

# compare_step(SCENE NAME file file COMMAND tool options...): figures of a step's output, NAME-compared.json.
function(compare_step scene name first second)
    set(report ${out}/${name}-compared.json)
    add_custom_command(OUTPUT ${report} ${ARGN} ${first} ${second} --json ${report} DEPENDS ${out}/${first} ${out}/${second}
                       COMMENT "Comparing ${name}" VERBATIM)
    add_custom_target(${name}-compared DEPENDS ${report})
    add_dependencies(${scene}-all ${name}-compared)
endfunction()

# add_picture(SCENE ATLAS NAME k options of rt-trace...): NAME.exr at k times the size, averaged to NAME-small.exr.
function(add_picture scene atlas name side)
    math(EXPR size "${RT_PICTURE_SIZE} * ${side}")
    rt_add_render(${name} ATLAS ${atlas} SIZE ${size}x${size} PASSES none ARGS ${ARGN})
    add_custom_command(OUTPUT ${name}-small.exr COMMAND ${RT_BOX_FILTER} ${name}.exr -o ${name}-small.exr --side ${side} -q
                       DEPENDS ${out}/${name}.exr ${RT_BOX_FILTER} COMMENT "Averaging ${name}" VERBATIM)
    add_dependencies(${scene}-all ${name})
endfunction()
