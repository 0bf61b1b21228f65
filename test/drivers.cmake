# Tests of the drivers: their codecs and rules (gtest), then the real nodes against simulated hardware (rostest).
foreach(name cameleon_codec cameleon_robot cameleon_status_parser motion_gate software_exposure tara_hid_codec tara_y16
        track_odometry)
  perennial_gtest(${name}_test core/drivers/${name}_test.cpp)
endforeach()

find_package(rostest REQUIRED)
foreach(name cameleon cameleon_stop)
  add_rostest(ros/drivers/${name}.test DEPENDENCIES cameleon_driver_node cameleon_simulator_node)
endforeach()
if(TARGET tara_camera_node)
  add_rostest(ros/drivers/tara.test DEPENDENCIES tara_camera_node tara_simulator_node perennial_tara_preload)
endif()
