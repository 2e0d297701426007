# Every ray set through every variant; a test holds the hits against Embree's.
function(start_tables scene)
    file(WRITE ${out}/${scene}.results.csv "scene,structure,options,set,atlas,step\n")
endfunction()

function(measure scene atlas case)
    foreach(ray_set IN LISTS RT_SETS)
        set(step ${atlas}-${ray_set})
        set(any_hit)
        if(ray_set STREQUAL shadow)
            set(any_hit --any-hit)
        endif()
        add_query(${scene} ${atlas} ${step} ${ray_set} ${any_hit} ${repeat_option})
        add_test(NAME ${step}
            COMMAND ${RT_CHECK_HITS} ${scene}/${ray_set}.hits ${step}.hits --rays ${scene}/${ray_set}.rays --mesh ${scene}.rtmesh
                    ${any_hit} --allow-per-million ${RT_ALLOW_PER_MILLION} --json ${step}-compared.json)
        set_tests_properties(${step} PROPERTIES LABELS ${scene})
        file(APPEND ${out}/${scene}.results.csv "${case},${ray_set},${atlas},${step}\n")
    endforeach()
endfunction()
