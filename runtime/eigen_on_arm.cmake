# On ARM: a copy of Eigen's headers in which NEON adds up as SSE does, so that poses have the bits that they have on
# x86-64. There, products and sums are rounded one by one, and floats are taken four at a time or one by one; Eigen's
# NEON fuses them, and takes two at a time as well. Sets SINEW_EIGEN to the folder of the copy.
get_target_property(found Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
set(SINEW_EIGEN ${CMAKE_CURRENT_BINARY_DIR}/eigen)
set(packets Eigen/src/Core/arch/NEON/PacketMath.h)

macro(mend from to)
  string(FIND "${text}" "${from}" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "sinew: in ${found}/${packets} there is no \"${from}\": it is not the one of Eigen 3.4")
  endif()
  string(REPLACE "${from}" "${to}" text "${text}")
endmacro()

if(NOT EXISTS ${SINEW_EIGEN}/${packets})  # else everything would be compiled again
  file(READ ${found}/${packets} text)
  mend("#ifdef __ARM_FEATURE_FMA" "#if 0  // rounded twice, as with SSE")
  mend("typedef Packet4f type;\n  typedef Packet2f half;" "typedef Packet4f type;\n  typedef Packet4f half;")
  mend("typedef Packet2f half;\n  typedef Packet4i integer_packet;" "typedef Packet4f half;\n  typedef Packet4i integer_packet;")
  file(COPY ${found}/Eigen DESTINATION ${SINEW_EIGEN})
  file(WRITE ${SINEW_EIGEN}/${packets} "${text}")
endif()
