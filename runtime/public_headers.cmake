# What a game includes: installed, together with what these headers include in turn (which is not for others to include, and may
# change at any time), and documented name by name. Everything else stays with the sources.
set(SINEW_PUBLIC_HEADERS
  c/sinew.h io/asset.h
  # skeleton
  skeleton/convex_hull.h skeleton/hooks.h skeleton/parallel_for.h skeleton/rotation.h skeleton/skeleton.h skeleton/status.h skeleton/version.h
  # animation
  animation/blend_space.h animation/blending_job.h animation/clip.h animation/crossfade.h animation/curve_job.h
  animation/event_job.h animation/foot_lock.h animation/foot_placement_job.h animation/inertialize_job.h
  animation/inverse_kinematics.h animation/jet_angles.h animation/joint_mask.h animation/look_at_job.h animation/look_chain.h
  animation/mesh_additive_job.h animation/mirror_job.h animation/model_motion_job.h animation/model_pose_job.h
  animation/morph_job.h animation/phase_map.h animation/root_motion.h animation/sampling_job.h animation/skinning_job.h
  animation/smooth_input.h animation/socket.h animation/soft_limits.h
  # graphs
  graph/graph.h graph/graph_file.h graph/graph_physics.h graph/graph_pose.h graph/graph_recorder.h graph/graph_state.h graph/graph_step.h
  graph/graph_update.h
  # characters and what surrounds them
  character/contact_events.h character/debug_draw.h character/fade_timer.h character/physics_values.h character/queries.h
  character/recording.h character/sensor.h character/spare_acceleration.h character/world.h
  behaviour/behaviour.h behaviour/get_up.h behaviour/get_up_clips.h
  crowd/crowd.h crowd/population.h
  # effects by their type
  character/contacts.h effects/buoyancy.h effects/check_batch.h effects/cloth.h effects/continuous_detection.h effects/effect.h
  effects/force_field.h effects/impulse.h effects/joint_damping.h effects/joint_limit.h effects/joint_spring.h effects/loop.h
  effects/muscle.h effects/particles.h effects/restitution.h effects/soft_tissue.h effects/static_shape.h effects/strand.h
  effects/support.h effects/wind.h)

# sinew_with_included(out folder HEADERS…): these and what they include of "sinew/…", paths within folder/sinew.
function(sinew_with_included out folder)
  set(found "")
  while(ARGN)
    list(POP_FRONT ARGN header)
    if(header IN_LIST found)
      continue()
    endif()
    list(APPEND found ${header})
    file(STRINGS ${folder}/sinew/${header} includes REGEX "^#include \"sinew/")
    foreach(line ${includes})
      string(REGEX REPLACE ".*\"sinew/(.*)\".*" "\\1" included "${line}")
      list(APPEND ARGN ${included})
    endforeach()
  endwhile()
  set(${out} ${found} PARENT_SCOPE)
endfunction()
