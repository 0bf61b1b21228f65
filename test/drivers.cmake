# Tests of the drivers: their codecs and rules (gtest), then the real nodes against simulated hardware (rostest).
foreach(name cameleon_codec cameleon_robot cameleon_status_parser motion_gate software_exposure tara_hid_codec tara_y16
        teleop track_odometry)
  perennial_gtest(${name}_test core/drivers/${name}_test.cpp)
endforeach()

foreach(name cameleon cameleon_stop teleop)
  add_rostest(ros/drivers/${name}.test DEPENDENCIES cameleon_driver_node cameleon_simulator_node teleop_node)
endforeach()
add_rostest(ros/two_machines.test
  ARGS folder:=${scratch}/two_machines
  DEPENDENCIES cameleon_driver_node cameleon_simulator_node map_manager_node perennial_strategies repeat_navigator_node
               teach_recorder_node)
add_rostest(ros/drivers/check_steering.test DEPENDENCIES check_steering_node)
if(TARGET tara_camera_node)
  perennial_gtest(tara_devices_test ros/drivers/tara_devices_test.cpp)
  if(TARGET tara_devices_test)
    target_link_libraries(tara_devices_test perennial_tara)
  endif()
  add_rostest(ros/drivers/killed.test
    ARGS folder:=${scratch}/killed
    DEPENDENCIES cameleon_driver_node cameleon_simulator_node map_manager_node perennial_strategies perennial_tara_preload
                 repeat_navigator_node tara_camera_node tara_simulator_node teach_recorder_node)
  foreach(name tara tara_setup)
    add_rostest(ros/drivers/${name}.test DEPENDENCIES tara_camera_node tara_simulator_node perennial_tara_preload)
  endforeach()
endif()
execute_process(
  COMMAND /usr/bin/python3 -c "import gi; gi.require_version('GstRtspServer', '1.0')"
  RESULT_VARIABLE no_rtsp_server OUTPUT_QUIET ERROR_QUIET
)
if(no_rtsp_server)
  message(STATUS "Test of cameleon_video_node left out: it needs gir1.2-gst-rtsp-server-1.0")
elseif(TARGET cameleon_video_node)
  add_rostest(ros/drivers/video.test DEPENDENCIES cameleon_video_node)
endif()
if(TARGET tara_camera_node AND TARGET park_simulator_node)
  add_rostest(ros/drivers/cameleon_park.test
    ARGS folder:=${scratch}/cameleon_park demo:=${PROJECT_SOURCE_DIR}/scripts/park_demo
    DEPENDENCIES cameleon_driver_node cameleon_simulator_node map_manager_node park_simulator_node perennial_strategies
                 perennial_tara_preload repeat_navigator_node tara_camera_node tara_simulator_node teach_recorder_node)
endif()
