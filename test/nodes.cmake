# Tests of what needs ROS: first without a master, then the real nodes.
perennial_gtest(lockstep_gate_test ros/lockstep_gate_test.cpp LIBRARIES perennial_ros)
perennial_gtest(focal_length_test ros/focal_length_test.cpp LIBRARIES perennial_ros)
perennial_gtest(strategy_conformance_test ros/strategy_conformance_test.cpp
  LIBRARIES ${catkin_LIBRARIES}
  DEPENDS perennial_strategies
)

set(perennial_nodes
  bag_player_node dataset_to_bag map_manager_node park_simulator_node perennial_strategies repeat_navigator_node
  teach_recorder_node)
foreach(name faults localise master_restart stops system)
  add_rostest(ros/${name}.test ARGS folder:=${scratch}/${name} DEPENDENCIES ${perennial_nodes})
endforeach()
add_rostest(ros/parameters.test DEPENDENCIES ${perennial_nodes})
add_rostest(ros/park.test
  ARGS folder:=${scratch}/park demo:=${PROJECT_SOURCE_DIR}/scripts/park_demo
  DEPENDENCIES ${perennial_nodes})

# What the nodes make of a bag is compared with what the core makes of it.
add_executable(core_displacements EXCLUDE_FROM_ALL ros/core_displacements.cpp)
target_link_libraries(core_displacements perennial_core perennial_evaluation)
add_dependencies(tests core_displacements)
set(core_displacements ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION}/core_displacements)
# The environment variable PERENNIAL_DATA names another one when the tests run.
get_filename_component(perennial_data ${PROJECT_SOURCE_DIR}/../shared/data ABSOLUTE)
add_rostest(ros/bags.test
  ARGS folder:=${scratch}/bags core_displacements:=${core_displacements} data:=${perennial_data}
  DEPENDENCIES ${perennial_nodes} core_displacements)
