# Compares a shipped HEADER with what FLATC writes of its SCHEMA.
execute_process(COMMAND ${FLATC} --cpp --scoped-enums -o ${WORK}/${LAYER} ${SCHEMA} COMMAND_ERROR_IS_FATAL ANY)
get_filename_component(name ${HEADER} NAME)
execute_process(COMMAND diff -u ${HEADER} ${WORK}/${LAYER}/${name} RESULT_VARIABLE code OUTPUT_VARIABLE out)
if(NOT code EQUAL 0)
  message(FATAL_ERROR "${out}\nflatc --cpp --scoped-enums -o ${HEADER}/.. ${SCHEMA} writes it anew")
endif()
